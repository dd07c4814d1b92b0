/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <limits>
#include <string>

namespace pcl_semantic {

/** \brief Frames numbered first <= n < end. */
struct FrameRange {
  int first = 0;
  int end = std::numeric_limits<int>::max();

  bool
  contains(int frame) const
  {
    return frame >= first && frame < end;
  }
};

/** \brief Reads "A:B", the frames A <= n < B; without A or B open on that side.
 * \throws InvalidParameterException if it is something else or holds no frame */
FrameRange parseFrameRange(const std::string& text);

} // namespace pcl_semantic
