// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief The inner loops of a permutohedral lattice. Its values are rows of `width`
 * floats: one for every vertex, then partial rows, in which a chunk of points
 * accumulates values for vertices of earlier chunks. */
namespace pcl_semantic::kernels {

constexpr int max_dimensions = 16;

/** \brief Points per batch of the embedding. */
constexpr std::size_t batch_points = 64;

/** \brief Flag of a blur step: the last vertex of its run. */
constexpr std::int32_t run_end = std::int32_t(1) << 31;

/** \brief Steps that blur() may read beyond the end of an array of steps. */
constexpr std::size_t steps_ahead = 32;

/** \brief Maps features to the plane of the lattice: coordinate j of a point, in units
 * of d + 1, is sum over k > j of x_k minus j x_j, x_k = scale[k] (f_(k-1) - low[k-1]).
 */
struct LatticeFrame {
  int dimensions;
  double low[max_dimensions];
  double scale[max_dimensions + 1];
};

/** \brief Simplices of 64 points. Vertex 0 has the coordinates (d + 1) cells[j]; vertex
 * k + 1 lies one step in direction directions[k] ahead of vertex k. */
struct LatticeBatch {
  std::int32_t cells[max_dimensions + 1][batch_points];
  std::int32_t directions[max_dimensions + 1][batch_points];
  float weights[max_dimensions + 1][batch_points];
};

/** \brief A chunk of points; the arrays start at its first point. */
struct LatticePoints {
  std::size_t count;
  std::size_t corners;            ///< of a simplex, d + 1
  const std::int32_t* columns;    ///< the caller's column numbers
  const std::int32_t* rows;       ///< of the corners around each point
  const float* weights;           ///< barycentric, of the corners
  std::size_t first_row;          ///< of the chunk
  std::size_t own_rows;           ///< number of the chunk's rows
  std::size_t first_partial;      ///< row
  std::size_t partials;           ///< number of partial rows
  const std::int32_t* represents; ///< vertex of each partial row
};

/** \brief Columns of the caller's matrices and their scales. */
struct LatticeColumns {
  const float* values; ///< the rows of interest
  const float* end;    ///< of the memory that contains values
  std::size_t values_stride;
  float* result;
  std::size_t result_stride;
  std::size_t rows;         ///< of interest, up to the width
  const float* splat_scale; ///< by column
  const float* slice_scale; ///< by column
  const float* diagonal;    ///< by column
};

/** \brief Finds the simplices of 64 points.
 * \param[in] features d per column
 * \param[in] columns of the points */
using LatticeEmbedding = void (*)(const LatticeFrame& frame, const float* features,
                                  const std::int32_t* columns, LatticeBatch& batch);

struct LatticeFilter {
  /** \brief Writes the rows of a chunk: sums of weight times scaled value. */
  void (*splat)(const LatticePoints& points, const LatticeColumns& columns,
                float* lattice);

  /** \brief Adds partial rows to the rows of their vertices.
   * \param[in] represents vertex of each partial row
   * \param[in] vertices number of rows before the partial ones */
  void (*merge)(const std::int32_t* partials, std::size_t count,
                const std::int32_t* represents, std::size_t vertices, float* lattice);

  /** \brief Blurs in one direction: adds half of both neighbours in its run to every
   * row. Steps count ... count + steps_ahead must be valid rows too.
   * \param[in] lattice the half to blur */
  void (*blur)(const std::int32_t* steps, std::size_t count, float* lattice);

  /** \brief Fills the partial rows. Then adds to the result of each point slice_scale
   * times the weighted sum around it, minus diagonal times its value.
   * \param[in] half offset of the copy that is blurred in the reverse order; the mean
   * of both is sliced */
  void (*slice)(const LatticePoints& points, const LatticeColumns& columns,
                float* lattice, std::size_t half);
};

/** \brief The loop for a tier; all tiers give identical bits. */
LatticeEmbedding latticeEmbedding(SimdTier tier);

/** \brief The loops for a tier and a width (1, 4, 8 or 16); all tiers give identical
 * bits. */
const LatticeFilter& latticeFilter(SimdTier tier, std::size_t width);

} // namespace pcl_semantic::kernels
