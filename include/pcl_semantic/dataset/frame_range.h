// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>

#include <limits>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

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

/** \brief Positions in a sequence of the frames that a range contains. */
std::vector<std::size_t> selectFrames(const FrameSequence& sequence,
                                      const FrameRange& range);

/** \brief Numbers and times of the frames at some positions in a sequence. */
std::vector<FrameTime> frameTimes(const FrameSequence& sequence,
                                  const std::vector<std::size_t>& positions);

} // namespace pcl_semantic
