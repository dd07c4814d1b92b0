// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A random sample of points, chosen and sorted by a hash of their positions, so
 * that the order of the points does not matter.
 * \param[in] positions finite
 * \param[in] count of the sample; fewer points are all in it
 * \param[in] step positions are rounded to it, so that their last bits do not matter;
 * those within a step are in the sample together. 0 = not rounded
 * \return their columns */
std::vector<Eigen::Index>
sampleByPosition(const Eigen::Ref<const Eigen::MatrixXf>& positions, std::size_t count,
                 float step = 0.0f);

/** \brief The spacing around some points of a cloud, which is given in parts; see
 * pointSpacing(). */
class SpacingSample {
public:
  static constexpr Eigen::Index neighbours = 4;

  /** \param[in] points of the cloud, d x n, finite */
  explicit SpacingSample(const Eigen::MatrixXf& points);

  /** \brief Adds a part of the cloud. The points of the sample are in one of the parts.
   * \param[in] axes positions, N x d, finite */
  void add(const Eigen::MatrixXf& axes);

  /** \brief The spacing in the cloud; infinite if it has fewer than five points. */
  float spacing() const;

private:
  using Squares = std::array<float, neighbours + 1>; // of distances, itself included

  static void addTo(Squares& nearest, const Eigen::VectorXf& point,
                    const Eigen::MatrixXf& axes);

  Eigen::MatrixXf points_;
  std::vector<Squares> squares_;
};

/** \brief Estimates the spacing of points: the step of their grid (voxels), or
 * otherwise the median distance to the fourth nearest neighbour, which equals that step
 * for a grid on a surface. Uses a sample chosen by position, so the order of the points
 * does not matter.
 * \param[in] positions finite
 * \return 0 if there are fewer than five points, or most of them coincide */
float pointSpacing(const Eigen::MatrixXf& positions);

} // namespace pcl_semantic
