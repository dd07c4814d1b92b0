// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/PointIndices.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads cliques, which may overlap, from a text file: one clique per line, its
 * point indices from 0, blank-separated. Empty lines and comments after `#` are
 * ignored.
 * \param[in] points size of the cloud; if omitted, any index is accepted
 * \return lists of indices, each ascending
 * \throws BadInputException that names the line: a word is no index, is not below \a
 * points, or occurs twice in a line */
std::vector<pcl::PointIndices>
readCliques(const std::string& path,
            std::size_t points = std::numeric_limits<pcl::index_t>::max());

} // namespace pcl_semantic
