// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What can be wrong with a rectified pair although both images can be read. */
enum class PairFault {
  none,
  blank,     ///< an image shows nothing: a covered lens, a black or a white frame
  identical, ///< both are the same image: there is no depth in it
  swapped,   ///< left is right and right is left, or both are mirrored
  unrelated  ///< rows do not show the same: another scene or moment, not rectified
};

/** \brief What the blocks of a sparse grid tell about a pair.
 *
 * A point lies in the right image at the left's column minus its disparity, which is
 * never negative. Textured blocks of the left image are sought along their row in both
 * directions, up to an eighth of the width. A match counts if it is clearly better than
 * the rest and is found again from the right image. Of the matches that are more than
 * about 0.3 % of the width away, good pairs have no more than 2 % in the wrong
 * direction and swapped ones no fewer than 98 % (doc/stereo.md). */
struct PairEvidence {
  double left_contrast = 0.0;  ///< deviation of coarse grey levels, 0 to 127
  double right_contrast = 0.0; ///< same
  bool is_identical = false;   ///< all bytes are the same
  int textured = 0;            ///< blocks that were sought
  int alike = 0;    ///< of those, how many look like some position of their row
  int matched = 0;  ///< like one position only, and are found again from there
  int forward = 0;  ///< of those, clearly further left in the right image
  int backward = 0; ///< same, clearly further right

  /** \brief None without clear evidence: repeated texture, too little of it, nothing
   * but far points, a few rows of vertical offset. */
  PairFault fault() const;

  /** \brief The fault and its figures as part of a sentence, "left and right are
   * swapped: ..."; empty if there is none. */
  std::string reason() const;
};

/** \brief Looks at one pair; takes about a millisecond.
 * \param[in] left CV_8UC3 (BGR) or CV_8UC1, of any size
 * \param[in] right as left
 * \throws BadInputException if the images do not fit each other */
PairEvidence gatherPairEvidence(const cv::Mat& left, const cv::Mat& right);

/** \brief The fault of one pair, see gatherPairEvidence(). */
inline PairFault
checkPair(const cv::Mat& left, const cv::Mat& right)
{
  return gatherPairEvidence(left, right).fault();
}

/** \brief Checks the pairs of a sequence. One that tells too little by itself is judged
 * together with those before it. */
class PairCheck {
public:
  /** \brief Takes the next pair and gives its fault. \throws as gatherPairEvidence() */
  PairFault add(const cv::Mat& left, const cv::Mat& right);

  /** \brief Why, see PairEvidence::reason(). */
  std::string
  reason() const
  {
    return judged_.reason();
  }

private:
  PairEvidence gathered_; // of the pairs so far, the older ones the less
  PairEvidence judged_;   // of the last pair
};

} // namespace pcl_semantic
