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

/** \brief Runs of one point. */
struct RunsView {
  const std::uint32_t* runs;
  std::size_t count;
  std::size_t pairs; ///< points in the runs
  std::size_t point;
};

struct TruncatedSums {
  /** \brief Values of each term at the pairs of a point, the one of the point with
   * itself included, and their sums. \param[in] scratch scratchSize() floats
   * \param[out] sums one a term \param[out] values an array of bfloat16 a term */
  void (*sumTerms)(const PointsView& points, const RunsView& runs, float* scratch,
                   float* sums, std::uint16_t* const* values);

  /** \brief Weights of the pairs of a point: sum over the terms of left[m] times
   * right[m][neighbour] times the value; 0 for the point itself.
   * \param[in,out] values as sumTerms gave them; the first become the weights */
  void (*makeWeights)(const RunsView& runs, int terms, const float* left,
                      const float* const* right, float* scratch,
                      std::uint16_t* const* values);

  /** \brief result[k] += sum over the pairs of weight values[neighbour * rows + k].
   * \param[in] rows a multiple of 16 */
  void (*addProduct)(const RunsView& runs, const std::uint16_t* weights,
                     const float* values, std::size_t rows, float* scratch,
                     float* result);
};

/** \brief Floats of scratch for a point with that many pairs: \a arrays of them, 3
 * more than all terms have features for sumTerms, one a term for makeWeights, 2 for
 * addProduct. */
std::size_t scratchSize(std::size_t pairs, std::size_t arrays);

/** \brief The loops for a tier. */
const TruncatedSums& truncatedSums(SimdTier tier);

} // namespace pcl_semantic::kernels
