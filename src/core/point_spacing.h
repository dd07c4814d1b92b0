// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A hash of positions, for samples that depend neither on the order of the
 * points nor on their origin. */
class PositionHash {
public:
  /** \param[in] low least coordinates of all points */
  explicit PositionHash(const Eigen::Vector3f& low) : low_(low.cast<double>()) {}

  std::uint64_t operator()(const Eigen::Vector3f& position) const;

private:
  Eigen::Vector3d low_;
};

/** \brief The points with the least hashes, in that order.
 * \param[in] positions 3 x N, finite
 * \param[in] count of the sample; fewer points are all in it
 * \return their columns */
std::vector<Eigen::Index> sampleByPosition(const Eigen::Matrix3Xf& positions,
                                           std::size_t count, const PositionHash& hash);

/** \brief Does the same with a hash of these positions. */
std::vector<Eigen::Index> sampleByPosition(const Eigen::Matrix3Xf& positions,
                                           std::size_t count);

/** \brief Points in the sample of a cloud's spacing, by the size of the cloud. */
std::size_t sizeOfSpacingSample(std::size_t points);

/** \brief The spacing around some points of a cloud, which is given in parts; see
 * pointSpacing(). */
class SpacingSample {
public:
  static constexpr Eigen::Index neighbours = 4;

  /** \param[in] points of the cloud, finite */
  explicit SpacingSample(const Eigen::Matrix3Xf& points);

  /** \brief Adds a part of the cloud. The points of the sample are in one of the parts.
   * \param[in] axes positions, N x 3, finite */
  void add(const Eigen::MatrixX3f& axes);

  /** \brief The spacing in the cloud; infinite if it has fewer than five points. */
  float spacing() const;

private:
  using Squares = std::array<float, neighbours + 1>; // of distances, itself included

  static void addTo(Squares& nearest, const Eigen::Vector3f& point,
                    const Eigen::MatrixX3f& axes);

  Eigen::Matrix3Xf points_;
  std::vector<Squares> squares_;
};

/** \brief Estimates the spacing of points: the step of their grid (voxels), or
 * otherwise the median distance to the fourth nearest neighbour, which equals that step
 * for a grid on a surface. Uses a sample.
 * \param[in] positions 3 x N, finite
 * \param[in] sample see sampleByPosition(), of sizeOfSpacingSample() or more
 * \return 0 if there are fewer than five points, or most of them coincide */
float pointSpacing(const Eigen::Matrix3Xf& positions,
                   const std::vector<Eigen::Index>& sample);

/** \brief Does the same with a sample of its own. */
float pointSpacing(const Eigen::Matrix3Xf& positions);

} // namespace pcl_semantic
