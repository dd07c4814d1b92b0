// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of TruncatedKernel, on raw arrays of sorted points; every
 * array has 16 values more than there are points. */
namespace pcl_semantic::kernels {

/** \brief A run of sorted points packs its first point and its length, 1 to 16. */
constexpr int run_length_bits = 5;
constexpr std::uint32_t run_length_mask = (1 << run_length_bits) - 1;
constexpr std::uint32_t longest_run = 16;

/** \brief Rows of points near a row, one array each, with 16 rows of no cells more. */
struct NearRowsView {
  const std::uint32_t* starts;      ///< number of points before each cell of all rows
  const std::int32_t* first_starts; ///< where in starts a row begins
  const std::int32_t* first_cells;  ///< of the rows
  const std::int32_t* cells;        ///< number of them
  const std::int32_t* widths;       ///< how far to look to each side [cells]
  std::size_t count;                ///< of the rows
};

constexpr std::size_t run_too_long = std::size_t(-1);

/** \brief A term, of values 2^-(squared distance of positions * position_scale +
 * squared distance of features). */
struct TermView {
  int dimensions;    ///< number of features
  std::size_t first; ///< of their arrays
};

/** \brief The points and the terms over them. */
struct PointsView {
  /// Positions x, y, z; features of the terms, by their deviations and times
  /// (log2(e) / 2)^1/2; for each term a factor of its values on the neighbour's side.
  const float* arrays;
  std::size_t stride;       ///< from one array to the next
  std::size_t features_end; ///< arrays of positions and features
  float squared_radius;     ///< pairs farther apart have weight 0
  float position_scale;     ///< log2(e) / (2 sigma^2), of all terms
  const TermView* terms;
  int count;                ///< of the terms
  const float* const* left; ///< factors on the point's side
};

/** \brief A group of points and the runs that hold the neighbours of all of them. A
 * pair is a point of the group and a point of the runs. */
struct GroupView {
  const std::uint32_t* runs;
  std::size_t count;  ///< of runs
  std::size_t length; ///< points in the runs
  std::size_t point;  ///< the first of the group
  int points;         ///< 1 to max_points
};

constexpr int max_points = 4;

/** \brief Weights are bfloat16, two in a word, strideOf(length) / 2 words for each
 * point: of each block of so many pairs the first half lies in the lower halves of the
 * words, the second half in the upper ones. */
constexpr std::size_t pair_block = 32;

struct TruncatedLoops {
  /** \brief Writes the runs of points that lie within the width of the cells first to
   * last in each row, leaving out empty ones.
   * \param[out] runs with room for count + 16
   * \return number of runs, or run_too_long if one is longer than longest_run */
  std::size_t (*findRuns)(const NearRowsView& rows, std::int32_t first,
                          std::int32_t last, std::uint32_t* runs);

  /** \brief Sums of the values of each term over the pairs of each point of a group,
   * that of a point with itself included. \param[in] scratch scratchSize() floats
   * \param[out] sums of term m and point p at m * max_points + p
   * \param[out] weights for makeWeights: what the positions leave of each value */
  void (*sumTerms)(const PointsView& points, const GroupView& group, float* scratch,
                   float* sums, std::uint32_t* weights);

  /** \brief Weights of the pairs of a group: sum over the terms of left[m][point] times
   * the neighbour's factor times the value; 0 for a point and itself.
   * \param[in,out] weights as sumTerms left them */
  void (*makeWeights)(const PointsView& points, const GroupView& group, float* scratch,
                      std::uint32_t* weights);

  /** \brief result[p * rows + k] += sum over the points j of the runs of
   * weight values[j * rows + k], for the points p of the group.
   * \param[in] rows a multiple of 16 */
  void (*addProduct)(const GroupView& group, const std::uint32_t* weights,
                     const float* values, std::size_t rows, float* scratch,
                     float* result);
};

/** \brief Values of a pair array of a point in the runs of a group. */
constexpr std::size_t
strideOf(std::size_t length)
{
  return (length + pair_block - 1) / pair_block * pair_block;
}

/** \brief Floats of scratch for groups with runs of that many points: \a arrays of
 * them, 1 + features_end for sumTerms and one a term more for makeWeights,
 * 1 + max_points for addProduct. */
std::size_t scratchSize(std::size_t length, std::size_t arrays);

/** \brief The loops for a tier; all tiers give the same bits. */
const TruncatedLoops& truncatedLoops(SimdTier tier = simdTier());

} // namespace pcl_semantic::kernels
