// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/semi_global.h"

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

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

} // namespace pcl_semantic
