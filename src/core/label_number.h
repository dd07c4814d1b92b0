// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fail.h"

#include "core/label_number.h"

#include <pcl_semantic/core/label_set.h>

#include <cstdint>

namespace pcl_semantic {

/** \brief Removes the instance in the upper bits of a label number, read as signed or
 * unsigned 32 bits: gives its classOf(). Numbers without instance and numbers beyond 32
 * bits stay unchanged. Negative numbers down to -65280 also stay, because other
 * programs write them for unlabelled; their bits would be the largest instances. */
constexpr std::int64_t
withoutInstance(std::int64_t number)
{
  constexpr std::int64_t instance = 1 << 16;
  const bool has_one = (number >= instance && number <= std::int64_t(UINT32_MAX)) ||
                       (number <= 255 - instance && number >= std::int64_t(INT32_MIN));
  return has_one ? std::int64_t(classOf(std::uint32_t(number))) : number;
}

/** \brief The first integer that single precision may not hold exactly. Labels with
 * instances from 256 on lose their class. */
constexpr double kFirstInexactFloat = 16777216.0;

/** \brief Converts a voxel label, stored with 32 bits in a cloud.
 * \throws BadInputException beyond 255 */
inline Label
requireLabel(std::uint32_t number)
{
  if (number > 255)
    badInput("a voxel has the label ", number, ", expected 0 to 255");
  return Label(number);
}

} // namespace pcl_semantic
