// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support_points.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Prior of every pixel of one of the two images, from the support points: the
 * disparity of the plane through the corners of its triangle, and the disparities of
 * support points near its cell. */
class PlanePrior {
public:
  static constexpr int cell_size = 10; // [px]

  /** \param[in] points in coordinates of this image, with disparities within the range
   * \param[in] disparities a multiple of 8 */
  PlanePrior(std::vector<SupportPoint> points, int width, int height, int disparities);

  /** \brief Expected disparities of rows [begin, end) [1 / disparity_steps px]. */
  void fillRows(int begin, int end, std::vector<std::int16_t>& expected) const;

  /** \brief The sets of the cells of a row of pixels, disparities / 8 bytes each. */
  const std::uint8_t*
  seen(int v) const
  {
    return seen_.data() + std::size_t(v / cell_size * columns_ * bytes_);
  }

private:
  struct Triangle {
    std::array<int, 3> u, v;                 ///< corners, from top to bottom
    float long_edge, upper_edge, lower_edge; ///< columns per row
    float at_zero, along_u, along_v;         ///< of the plane
  };

  void addTriangle(const SupportPoint& a, const SupportPoint& b, const SupportPoint& c);

  void markSeen(const std::vector<SupportPoint>& points);

  int width_;
  int columns_, rows_; // of the cells
  int bytes_;          // per cell
  std::vector<Triangle> triangles_;
  std::vector<std::uint8_t> seen_;
};

/** \brief Converts the points to coordinates of the right image; of two at the same
 * pixel the nearer one is kept. */
std::vector<SupportPoint> seenFromRight(const std::vector<SupportPoint>& points);

} // namespace pcl_semantic
