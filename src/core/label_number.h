// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fail.h"

#include "core/label_number.h"

#include <pcl_semantic/core/label_set.h>

#include <cstdint>

namespace pcl_semantic {

/** \brief A number as it is read for a label, without the instance in its upper bits:
 * classOf() of one that has an instance, whether its 32 bits were read with a sign or
 * not. Others stay: small ones, and those beyond 32 bits, which are no labels. Negative
 * ones to -65280 are what other programs write for unlabelled: of a class to 255 their
 * bits are those of the largest instance from there on. */
constexpr std::int64_t
withoutInstance(std::int64_t number)
{
  constexpr std::int64_t instance = 1 << 16;
  const bool has_one = (number >= instance && number <= std::int64_t(UINT32_MAX)) ||
                       (number <= 255 - instance && number >= std::int64_t(INT32_MIN));
  return has_one ? std::int64_t(classOf(std::uint32_t(number))) : number;
}

/** \brief The first whole number that single precision need not hold exactly: of labels
 * with instances from 256 on, the class is lost. */
constexpr double kFirstInexactFloat = 16777216.0;

/** \brief The label of a voxel, which a cloud holds in 32 bits.
 * \throws BadInputException beyond 255 */
inline Label
requireLabel(std::uint32_t number)
{
  if (number > 255)
    badInput("a voxel has the label ", number, ", expected 0 to 255");
  return Label(number);
}

} // namespace pcl_semantic
