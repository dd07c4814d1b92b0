// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of a permutohedral lattice. Values on it are rows of `width`
 * floats: one for every vertex, then partial rows, where a chunk of points sums what
 * belongs to vertices of earlier chunks. */
namespace pcl_semantic::kernels {

constexpr int max_dimensions = 16;

/** \brief Points that are embedded at a time. */
constexpr std::size_t batch_points = 64;

/** \brief Bit of a step of a blur: the last vertex of its run. */
constexpr std::int32_t run_end = std::int32_t(1) << 31;

/** \brief Steps that blur() may look ahead at the end of an array of steps. */
constexpr std::size_t steps_ahead = 32;

/** \brief From features to the plane of the lattice: coordinate j of a point, in units
 * of d + 1, is sum over k > j of x_k less j x_j, x_k = scale[k] (f_(k-1) - low[k-1]).
 */
struct LatticeFrame {
  int dimensions;
  double low[max_dimensions];
  double scale[max_dimensions + 1];
};

/** \brief Simplices of 64 points. The vertex 0 has the coordinates (d + 1) cells[j];
 * vertex k + 1 lies one step in direction directions[k] ahead of vertex k. */
struct LatticeBatch {
  std::int32_t cells[max_dimensions + 1][batch_points];
  std::int32_t directions[max_dimensions + 1][batch_points];
  float weights[max_dimensions + 1][batch_points];
};

/** \brief A chunk of points: arrays from its first one on. */
struct LatticePoints {
  std::size_t count;
  std::size_t corners;            ///< of a simplex, d + 1
  const std::int32_t* columns;    ///< the numbers that the caller knows them by
  const std::int32_t* rows;       ///< of the corners around each point
  const float* weights;           ///< barycentric, of the corners
  std::size_t first_row;          ///< of the chunk's own
  std::size_t own_rows;           ///< number of them
  std::size_t first_partial;      ///< row
  std::size_t partials;           ///< number of them
  const std::int32_t* represents; ///< vertex of each partial row
};

/** \brief Columns of the caller's matrices, and their scales. */
struct LatticeColumns {
  const float* values; ///< the rows of interest
  const float* end;    ///< of the memory behind values
  std::size_t values_stride;
  float* result;
  std::size_t result_stride;
  std::size_t rows;         ///< of interest, up to the width
  const float* splat_scale; ///< by column
  const float* slice_scale; ///< by column
  const float* diagonal;    ///< by column
};

/** \brief Finds the simplices of 64 points. \param[in] features d a column
 * \param[in] columns of the points */
using LatticeEmbedding = void (*)(const LatticeFrame& frame, const float* features,
                                  const std::int32_t* columns, LatticeBatch& batch);

struct LatticeFilter {
  /** \brief Writes the rows of a chunk: sums of weight times scaled value. */
  void (*splat)(const LatticePoints& points, const LatticeColumns& columns,
                float* lattice);

  /** \brief Adds some partial rows to those of their vertices. \param[in] represents
   * vertex of each partial row \param[in] vertices rows before the partial ones */
  void (*merge)(const std::int32_t* partials, std::size_t count,
                const std::int32_t* represents, std::size_t vertices, float* lattice);

  /** \brief One direction: adds half of both neighbours in its run to every row. Steps
   * count ... count + steps_ahead are rows too. \param[in] lattice the half to blur */
  void (*blur)(const std::int32_t* steps, std::size_t count, float* lattice);

  /** \brief Fills the partial rows, and adds slice_scale times the weighted sum around
   * a point less diagonal times its value to its result. \param[in] half where the rows
   * are once more, blurred in the reverse order: means of both are sliced */
  void (*slice)(const LatticePoints& points, const LatticeColumns& columns,
                float* lattice, std::size_t half);
};

/** \brief The loop for a tier. All give the same bits. */
LatticeEmbedding latticeEmbedding(SimdTier tier);

/** \brief The loops for a tier and a width (1, 4, 8 or 16). All tiers give the same
 * bits. */
const LatticeFilter& latticeFilter(SimdTier tier, std::size_t width);

} // namespace pcl_semantic::kernels
