// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Faults of a rectified pair whose images can both be read. */
enum class PairFault {
  none,
  blank,     ///< an image shows nothing: a covered lens, a black or a white frame
  identical, ///< both are the same image: there is no depth in it
  swapped,   ///< left is right and right is left, or both are mirrored
  unrelated  ///< rows do not show the same: another scene or moment, not rectified
};

/** \brief A fault, and its figures as part of a sentence. */
struct PairReport {
  PairFault fault = PairFault::none;
  std::string reason; ///< "left and right are swapped: ..."; empty if there is none
};

/** \brief Looks at one pair; takes about a millisecond.
 *
 * A point lies in the right image at the left's column minus its disparity, which is
 * never negative. Textured blocks of the left image are sought along their row in both
 * directions, up to an eighth of the width. A match counts if it is clearly better than
 * the rest and is found again from the right image. Of the matches that are more than
 * about 0.3 % of the width away, good pairs have no more than 2 % in the wrong
 * direction and swapped ones no fewer than 98 % (doc/stereo.md). Repeated texture, too
 * little of it, far points only and a few rows of vertical offset are no fault.
 * \param[in] left CV_8UC3 (BGR) or CV_8UC1, of any size
 * \param[in] right as left
 * \throws BadInputException if the images do not fit each other */
PairReport checkPair(const cv::Mat& left, const cv::Mat& right);

} // namespace pcl_semantic
