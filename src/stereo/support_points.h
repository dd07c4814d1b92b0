// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/elas_loops.h"

#include <opencv2/core/mat.hpp>

#include <vector>

namespace pcl_semantic {

/** \brief Gradients of a grey image, from which descriptors are made. */
class GradientImage {
public:
  /** \param[in] grey CV_8UC1 */
  explicit GradientImage(const cv::Mat& grey);

  int
  width() const
  {
    return width_;
  }

  int
  height() const
  {
    return height_;
  }

  /** \brief Descriptors of the pixels of a row, with a margin of
   * kernels::descriptor_margin on both sides; rows outside the image repeat the border.
   */
  void describeRow(int v, std::vector<std::uint8_t>& row) const;

  /** \brief First pixel of a row of describeRow(). */
  static const std::uint8_t*
  firstPixel(const std::vector<std::uint8_t>& row)
  {
    return row.data() + kernels::descriptor_margin * kernels::descriptor_bytes;
  }

private:
  int width_, height_, stride_;
  std::vector<std::uint8_t> horizontal_, vertical_;
};

/** \brief A pixel of the left image with a reliable match in the right one. */
struct SupportPoint {
  int u, v;
  int disparity; ///< [1 / disparity_steps px]
};

/** \brief Matches the pixels of a grid over the whole range of disparities and keeps
 * reliable matches (section 3.1 of the paper), in order of rows. */
std::vector<SupportPoint> findSupportPoints(const GradientImage& left,
                                            const GradientImage& right,
                                            int disparities);

/** \brief Adds the image's corners with the disparity of the nearest support point. */
void addCorners(int width, int height, std::vector<SupportPoint>& points);

} // namespace pcl_semantic
