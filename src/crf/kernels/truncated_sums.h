/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/simd.h>

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of TruncatedKernel, on raw arrays of sorted points. A run is
 * a first point shifted by 5 bits and a length of 1 to 16; every array of the points
 * has 16 values more than there are points. */
namespace pcl_semantic::kernels {

/** \brief 2^-(squared distance of positions * position_scale + squared distance of
 * features). */
struct TermView {
  float position_scale;         ///< log2(e) / (2 sigma^2)
  const float* const* features; ///< by their deviations, times (log2(e) / 2)^1/2
  int dimensions;               ///< number of features
};

/** \brief The points and the terms over them. */
struct PointsView {
  const float* position[3];
  float squared_radius; ///< pairs farther apart have weight 0
  const TermView* terms;
  int count; ///< of the terms
};

/** \brief A group of points and the runs that hold the neighbours of all of them. A
 * pair is a point of the group and a point of the runs. */
struct GroupView {
  const std::uint32_t* runs;
  std::size_t count;  ///< of runs
  std::size_t length; ///< points in the runs
  std::size_t point;  ///< the first of the group
  int points;         ///< 1 to most_points
};

constexpr int most_points = 4;

struct TruncatedSums {
  /** \brief Values of each term at the pairs of a group, those of a point with itself
   * included, and their sums. \param[in] scratch scratchSize() floats
   * \param[out] sums one a term and point \param[out] values for each term arrays of
   * bfloat16, one a point with strideOf(length) values */
  void (*sumTerms)(const PointsView& points, const GroupView& group, float* scratch,
                   float* sums, std::uint16_t* const* values);

  /** \brief Weights of the pairs of a group: sum over the terms of left[m][point] times
   * right[m][neighbour] times the value; 0 for a point and itself.
   * \param[in,out] values as sumTerms gave them; the first become the weights */
  void (*makeWeights)(const GroupView& group, int terms, const float* const* left,
                      const float* const* right, float* scratch,
                      std::uint16_t* const* values);

  /** \brief result[p * rows + k] += sum over the points j of the runs of
   * weight values[j * rows + k], for the points p of the group.
   * \param[in] rows a multiple of 16 */
  void (*addProduct)(const GroupView& group, const std::uint16_t* weights,
                     const float* values, std::size_t rows, float* scratch,
                     float* result);
};

/** \brief Values of a pair array of a point in the runs of a group. */
constexpr std::size_t
strideOf(std::size_t length)
{
  return (length + 15) / 16 * 16;
}

/** \brief Floats of scratch for groups with runs of that many points: \a arrays of
 * them, 4 more than all terms have features for sumTerms, one a term for makeWeights,
 * 1 + most_points for addProduct. */
std::size_t scratchSize(std::size_t length, std::size_t arrays);

/** \brief The loops for a tier. */
const TruncatedSums& truncatedSums(SimdTier tier);

} // namespace pcl_semantic::kernels
