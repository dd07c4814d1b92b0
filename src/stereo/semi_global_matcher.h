// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/semi_global.h"

#include <pcl_semantic/stereo/disparity_engines.h>

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Semi-global matching (H. Hirschmueller, Stereo processing by semiglobal
 * matching and mutual information, PAMI 2008) of census signatures in blocks of 5 x 5
 * pixels, along three directions: from the left, from the right, from above.
 *
 * Small segments are dropped, disparities smoothed and gaps filled as Elas does. The
 * image is matched in bands of rows, whose paths begin some rows above: the result does
 * not depend on the number of threads nor on the instruction set. */
class SemiGlobalMatcher : public DisparityEstimator {
public:
  /** \param[in] disparities largest disparity + 1 [px]; 64, 128, 192 or 256 */
  explicit SemiGlobalMatcher(int disparities) : disparities_(disparities) {}

  DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) override;

private:
  int disparities_;
};

/** \brief Which pixels around a pixel are darker than it, for all pixels of an image:
 * every other one of 9 x 7, 31 bits (R. Zabih and J. Woodfill, Non-parametric local
 * transforms for computing visual correspondence, ECCV 1994). Beyond the border the
 * image goes on as it ends. */
class CensusImage {
public:
  enum class Order { forwards, backwards }; ///< of the pixels in a row

  /** \param[in] grey CV_8UC1
   * \param[in] padding copies of the last pixel behind each row */
  CensusImage(const cv::Mat& grey, Order order, int padding);

  /** \brief One byte of each pixel's census in a row. */
  const std::uint8_t*
  row(int byte, int v) const
  {
    return bytes_[std::size_t(byte)].data() + std::size_t(v) * stride_;
  }

private:
  void computeRow(const cv::Mat& padded, int width, Order order, int v);

  std::size_t stride_;
  std::array<std::vector<std::uint8_t>, kernels::census_bytes> bytes_;
};

/** \brief Matches bands of rows, one after the other; one a thread. */
class SemiGlobalBand {
public:
  /** \brief The images of a pair; they have to stay. */
  struct Pair {
    const cv::Mat& grey; ///< the left one
    const CensusImage &left, &right;
  };

  SemiGlobalBand(const Pair& pair, int disparities, SimdTier tier = simdTier());

  /** \brief Matches the rows begin <= v < end. Paths from above begin at most 16 rows
   * before.
   * \param[out] disparity CV_16SC1 as of disparity_cleaning.h; below 0 = none */
  void match(int begin, int end, cv::Mat& disparity);

private:
  using Bytes = std::vector<std::uint8_t>;
  using Shorts = std::vector<std::uint16_t>;

  const std::uint8_t* costsOf(int v);
  kernels::PathRow pathRow(int v);
  kernels::RowMatches clearMatches();
  std::int16_t matchOf(int u) const;

  const Pair pair_;
  const kernels::SemiGlobal& loops_;
  const int width_, disparities_;
  std::array<std::uint8_t, 256> large_step_; // by difference of grey levels
  std::array<Bytes, 5> rows_;                // costs of pixels; row v in place v % 5
  int next_row_ = 0;                         // the first that is not in there
  Bytes added_row_, row_sums_, quarters_, costs_, steps_down_, steps_along_;
  Bytes down_, smallest_down_, along_;
  Shorts sums_;
  Bytes best_, has_rival_;
  Shorts around_, right_sum_[2], right_disparity_[2];
};

} // namespace pcl_semantic
