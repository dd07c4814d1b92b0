// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Fault of a readable rectified pair. */
enum class PairFault {
  none,
  blank,     ///< an image without content: a covered lens, a black or white frame
  identical, ///< both are the same image, without depth information
  swapped,   ///< left and right are swapped, or both are mirrored
  unrelated  ///< rows do not match: another scene or time, or not rectified
};

struct PairReport {
  PairFault fault = PairFault::none;
  std::string reason; ///< "left and right are swapped: ..."; empty if there is no fault
};

/** \brief Checks one pair; takes about a millisecond.
 *
 * A point lies in the right image at the left's column minus its disparity, which is
 * never negative. The check searches textured blocks of the left image along their row
 * in both directions, up to an eighth of the width. A match counts if it is clearly
 * better than the alternatives and passes the left-right check. Among matches with a
 * shift of more than about 0.3 % of the width, good pairs have at most 2 % in the wrong
 * direction and swapped ones at least 98 % (doc/stereo.md). Repeated or little texture,
 * only far points and a vertical offset of a few rows are no fault.
 * \param[in] left CV_8UC3 (BGR) or CV_8UC1, of any size
 * \param[in] right as left
 * \throws BadInputException if the images do not match in size or type */
PairReport checkPair(const cv::Mat& left, const cv::Mat& right);

} // namespace pcl_semantic
