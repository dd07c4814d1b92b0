// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic::tool {

/** \brief A path that is given once for many sequences: {sequence} stands for the path
 * of the sequence, {name} for the last part of it. */
std::string filledIn(const std::string& pattern, const std::string& sequence);

} // namespace pcl_semantic::tool
