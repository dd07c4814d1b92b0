// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>

#include <pcl/types.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace pcl_semantic {

/** \brief The indices of an extraction, ascending and each once.
 * \param[in] extraction its name, for messages
 * \param[in] points size of its cloud
 * \throws InvalidParameterException if an index is out of range */
inline pcl::Indices
usedIndices(const std::string& extraction, pcl::Indices indices, std::size_t points)
{
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  for (const pcl::index_t i : indices)
    if (i < 0 || std::size_t(i) >= points)
      throw InvalidParameterException(extraction + ": index " + std::to_string(i) +
                                      " is out of range");
  return indices;
}

} // namespace pcl_semantic
