// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of TruncatedKernel, on raw arrays of sorted points; every
 * array is padded by 16 values. */
namespace pcl_semantic::kernels {

/** \brief A run of sorted points packs its first point and its length, 1 to 16. */
constexpr int run_length_bits = 5;
constexpr std::uint32_t run_length_mask = (1 << run_length_bits) - 1;
constexpr std::uint32_t longest_run = 16;

/** \brief Rows of points near a row as one array per member, padded by 16 rows without
 * cells. */
struct NearRowsView {
  const std::uint32_t* starts;      ///< number of points before each cell of all rows
  const std::int32_t* first_starts; ///< index in starts of the beginning of a row
  const std::int32_t* first_cells;  ///< of the rows
  const std::int32_t* cells;        ///< number of them
  const std::int32_t* widths;       ///< cells to search on each side
  std::size_t count;                ///< of the rows
};

constexpr std::size_t run_too_long = std::size_t(-1);

/** \brief A Gaussian term with the values 2^-(squared distance of positions *
 * position_scale + squared distance of features). */
struct TermView {
  int dimensions;    ///< number of features
  std::size_t first; ///< of their arrays
};

/** \brief The points and the terms over them. */
struct PointsView {
  /// Positions x, y, z; features of the terms, divided by their deviations and times
  /// (log2(e) / 2)^1/2; for each term a factor on the neighbour's side.
  const float* arrays;
  std::size_t stride;       ///< from one array to the next
  std::size_t features_end; ///< arrays of positions and features
  float squared_radius;     ///< pairs farther apart have weight 0
  float position_scale;     ///< log2(e) / (2 sigma^2), of all terms
  const TermView* terms;
  int count;                ///< of the terms
  const float* const* left; ///< factors on the point's side
};

/** \brief A group of points and the runs with all their neighbours. A pair is a point
 * of the group and a point of the runs. */
struct GroupView {
  const std::uint32_t* runs;
  std::size_t count;  ///< of runs
  std::size_t length; ///< points in the runs
  std::size_t point;  ///< the first of the group
  int points;         ///< 1 to max_points
};

constexpr int max_points = 4;

/** \brief Pairs in a block of weights. Weights are bfloat16, two per word,
 * strideOf(length) / 2 words for each point: the first half of a block is in the lower
 * halves of the words, the second half in the upper ones. */
constexpr std::size_t pair_block = 32;

struct TruncatedLoops {
  /** \brief Writes the non-empty runs of points within the width of the cells first to
   * last in each row.
   * \param[out] runs with capacity for count + 16
   * \return number of runs, or run_too_long if one is longer than longest_run */
  std::size_t (*findRuns)(const NearRowsView& rows, std::int32_t first,
                          std::int32_t last, std::uint32_t* runs);

  /** \brief Drops the points at the ends of the runs of a group that lie beyond the
   * radius around the box of its points, and runs of which none is left.
   * \param[out] trimmed may be the runs of the group
   * \return number of trimmed runs */
  std::size_t (*trimRuns)(const PointsView& points, const GroupView& group,
                          std::uint32_t* trimmed);

  /** \brief Sums the values of each term over the pairs of each point of a group,
   * including the pair of a point with itself.
   * \param[in] scratch scratchSize() floats
   * \param[out] sums of term m and point p at m * max_points + p
   * \param[out] weights input of makeWeights: the position factors */
  void (*sumTerms)(const PointsView& points, const GroupView& group, float* scratch,
                   float* sums, std::uint32_t* weights);

  /** \brief Computes the weights of the pairs of a group: sum over the terms of
   * left[m][point] times the neighbour's factor times the value; 0 for a point with
   * itself.
   * \param[in,out] weights from sumTerms */
  void (*makeWeights)(const PointsView& points, const GroupView& group, float* scratch,
                      std::uint32_t* weights);

  /** \brief result[p * rows + k] += sum over the points j of the runs of
   * weight values[j * rows + k], for the points p of the group.
   * \param[in] rows a multiple of 16 */
  void (*addProduct)(const GroupView& group, const std::uint32_t* weights,
                     const float* values, std::size_t rows, float* scratch,
                     float* result);
};

/** \brief Values per point in a pair array, from the length of the runs of its group.
 */
constexpr std::size_t
strideOf(std::size_t length)
{
  return (length + pair_block - 1) / pair_block * pair_block;
}

/** \brief Floats of scratch for groups with runs of \a length points in \a arrays
 * arrays: 1 + features_end for sumTerms, one more per term for makeWeights, 1 +
 * max_points for addProduct. */
std::size_t scratchSize(std::size_t length, std::size_t arrays);

/** \brief The loops for a tier; all tiers give identical bits. */
const TruncatedLoops& truncatedLoops(SimdTier tier = simdTier());

} // namespace pcl_semantic::kernels
