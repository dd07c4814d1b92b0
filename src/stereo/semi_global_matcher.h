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
 * Small segments are removed, disparities smoothed and gaps filled as in Elas. The
 * image is matched in bands of rows, whose paths begin some rows above. The result
 * depends neither on the number of threads nor on the instruction set. */
class SemiGlobalMatcher : public DisparityEstimator {
public:
  /** \param[in] disparities largest disparity + 1 [px]; 64, 128, 192 or 256 */
  explicit SemiGlobalMatcher(int disparities) : disparities_(disparities) {}

  DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) override;

private:
  int disparities_;
};

/** \brief Census transform: for each pixel, which pixels around it are darker, every
 * other one of 9 x 7, 31 bits (R. Zabih and J. Woodfill, Non-parametric local
 * transforms for computing visual correspondence, ECCV 1994). Border pixels are
 * replicated. */
class CensusImage {
public:
  enum class Order { forwards, backwards }; ///< of the pixels in a row

  /** \param[in] grey CV_8UC1
   * \param[in] padding copies of the last pixel after each row */
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

/** \brief Matches bands of rows sequentially; one per thread. */
class SemiGlobalBand {
public:
  /** \brief The images of a pair, which must outlive this object. */
  struct Pair {
    const cv::Mat& grey; ///< the left one
    const CensusImage &left, &right;
  };

  SemiGlobalBand(const Pair& pair, int disparities, SimdTier tier = simdTier());

  /** \brief Matches the rows begin <= v < end. Paths from above begin at most 16 rows
   * earlier.
   * \param[out] disparity CV_16SC1, see disparity_cleaning.h; below 0 = none */
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
  std::array<std::uint8_t, 256> large_step_; // by grey level difference
  std::array<Bytes, 5> rows_;                // costs of pixels; row v has index v % 5
  int next_row_ = 0;                         // first row that is not yet included
  Bytes added_row_, row_sums_, quarters_, costs_, steps_down_, steps_along_;
  Bytes down_, smallest_down_, along_;
  Shorts sums_;
  Bytes best_, has_rival_;
  Shorts around_, right_sum_[2], right_disparity_[2];
};

} // namespace pcl_semantic
