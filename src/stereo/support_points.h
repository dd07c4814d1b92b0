// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/elas_loops.h"

#include <opencv2/core/mat.hpp>

#include <vector>

namespace pcl_semantic {

/** \brief The gradients of a grey image. A descriptor of a pixel consists of gradients
 * near the pixel. */
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

  /** \brief Computes the descriptors of the pixels of a row. Rows outside the image
   * repeat the border.
   * \param[in] v row [px], may be outside the image
   * \param[out] row kernels::descriptor_bytes per pixel. kernels::descriptor_margin
   * pixels precede the first pixel, and at least as many follow the last */
  void describeRow(int v, std::vector<std::uint8_t>& row) const;

  /** \brief Descriptor of pixel 0 in a row of describeRow(). */
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
  int u, v;      ///< column and row [px]
  int disparity; ///< in units of 1 / kernels::disparity_steps px
};

/** \brief Finds the reliable matches on a grid of pixels (section 3.1 of the paper by
 * Geiger et al., see Elas). Each pixel is compared over the whole range of disparities.
 * \param[in] disparities largest disparity + 1 [px]
 * \return points in the order of rows */
std::vector<SupportPoint> findSupportPoints(const GradientImage& left,
                                            const GradientImage& right,
                                            int disparities);

/** \brief Adds the corners of the image as support points. Each takes the disparity of
 * the nearest support point.
 * \param[in] width, height size of the image [px]
 * \param[in,out] points at least one */
void addCorners(int width, int height, std::vector<SupportPoint>& points);

} // namespace pcl_semantic
