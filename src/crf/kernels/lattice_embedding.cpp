// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_embedding.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/lattice_embedding.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

// Every loop over lanes is one that the compiler turns into vectors.
constexpr std::size_t lanes = batch_points;

// Coordinates on the plane as cells, to the nearest, and what is left over.
void
elevate(const LatticeFrame& frame, const float* features, const std::int32_t* columns,
        LatticeBatch& batch, float (&left)[max_dimensions + 1][lanes])
{
  constexpr double magic = 6755399441055744.0; // 1.5 * 2^52: rounds what it is added to
  double sum[lanes] = {}, x[lanes];
  for (int j = frame.dimensions; j >= 0; --j) {
    if (j > 0)
      for (std::size_t i = 0; i < lanes; ++i)
        x[i] = double(features[std::size_t(columns[i]) * std::size_t(frame.dimensions) +
                               std::size_t(j) - 1]);
    const double low = j > 0 ? frame.low[j - 1] : 0.0, scale = frame.scale[j];
    for (std::size_t i = 0; i < lanes; ++i) {
      const double step = j > 0 ? (x[i] - low) * scale : 0.0;
      const double coordinate = sum[i] - double(j) * step;
      const double nearest = coordinate + magic - magic;
      sum[i] += step;
      batch.cells[j][i] = std::int32_t(nearest);
      left[j][i] = float(coordinate - nearest);
    }
  }
}

// Ranks of what is left over, largest first, and back onto the plane: the sum of the
// cells, which is the excess of the ranks, becomes 0.
void
rank(int d, LatticeBatch& batch, float (&left)[max_dimensions + 1][lanes],
     std::int32_t (&ranks)[max_dimensions + 1][lanes])
{
  std::int32_t excess[lanes] = {};
  for (int j = 0; j <= d; ++j)
    for (std::size_t i = 0; i < lanes; ++i) {
      excess[i] += batch.cells[j][i];
      ranks[j][i] = 0;
    }
  for (int j = 0; j < d; ++j)
    for (int l = j + 1; l <= d; ++l)
      for (std::size_t i = 0; i < lanes; ++i) {
        const std::int32_t less = left[j][i] < left[l][i] ? 1 : 0;
        ranks[j][i] += less;
        ranks[l][i] += 1 - less;
      }
  for (int j = 0; j <= d; ++j)
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::int32_t moved = ranks[j][i] + excess[i];
      const std::int32_t turn = moved < 0 ? 1 : moved > d ? -1 : 0;
      ranks[j][i] = moved + turn * (d + 1);
      batch.cells[j][i] += turn;
      left[j][i] -= float(turn);
    }
}

void
embed(const LatticeFrame& frame, const float* features, const std::int32_t* columns,
      LatticeBatch& batch)
{
  const int d = frame.dimensions;
  float left[max_dimensions + 1][lanes];
  std::int32_t ranks[max_dimensions + 1][lanes];
  elevate(frame, features, columns, batch, left);
  rank(d, batch, left, ranks);
  // Sorted, what is left over gives the barycentric weights as differences.
  float sorted[max_dimensions + 1][lanes];
  for (int k = 0; k <= d; ++k) {
    for (std::size_t i = 0; i < lanes; ++i) {
      sorted[k][i] = 0.0f;
      batch.directions[k][i] = 0;
    }
    for (int j = 0; j <= d; ++j)
      for (std::size_t i = 0; i < lanes; ++i) {
        const bool is_next = ranks[j][i] == d - k;
        sorted[k][i] = is_next ? left[j][i] : sorted[k][i];
        batch.directions[k][i] = is_next ? j : batch.directions[k][i];
      }
  }
  for (std::size_t i = 0; i < lanes; ++i)
    batch.weights[0][i] = sorted[0][i] + (1.0f - sorted[d][i]);
  for (int k = 1; k <= d; ++k)
    for (std::size_t i = 0; i < lanes; ++i)
      batch.weights[k][i] = sorted[k][i] - sorted[k - 1][i];
}

// Sums what comes back from vertex k of the simplices: a value gets from there to
// vertex k + m (modulo d + 1) by one step ahead in m directions, or one step back in
// the d + 1 - m others, each of half weight.
void
addPathsFrom(const LatticePaths& paths, int k,
             const std::int32_t (&rows)[max_dimensions + 1][lanes],
             const float (&weights)[max_dimensions + 1][lanes], float* responses)
{
  const int corners = paths.dimensions + 1;
  const std::uint32_t all = (std::uint32_t(1) << corners) - 1;
  std::uint32_t set[lanes] = {};
  std::uint64_t first[lanes], second[lanes];
  for (int m = 0; m <= corners; ++m) {
    if (m > 0)
      for (std::size_t i = 0; i < lanes; ++i)
        set[i] |= std::uint32_t(1)
                  << (paths.dimensions -
                      paths.directions[std::size_t((k + m - 1) % corners) * lanes + i]);
    if (paths.words > 1 || m == 0)
      for (std::size_t i = 0; i < lanes; ++i) {
        const std::size_t row = std::size_t(rows[k][i]) * 2 * paths.words;
        first[i] = paths.sets[row + set[i] / 64];
        second[i] = paths.sets[row + paths.words + (all ^ set[i]) / 64];
      }
    const float weight_ahead = 1.0f / float(std::uint32_t(1) << m);
    const float weight_back = // no step at all is counted once
        m == corners ? 0.0f : 1.0f / float(std::uint32_t(1) << (corners - m));
    const int end = (k + m) % corners;
    for (std::size_t i = 0; i < lanes; ++i) {
      const auto ahead = std::int32_t(first[i] >> (set[i] % 64)) & 1;
      const auto back = std::int32_t(second[i] >> ((all ^ set[i]) % 64)) & 1;
      responses[i] += weights[k][i] * weights[end][i] *
                      (float(ahead) * weight_ahead + float(back) * weight_back);
    }
  }
}

void
selfResponse(const LatticePaths& paths, float* responses)
{
  std::int32_t rows[max_dimensions + 1][lanes];
  float weights[max_dimensions + 1][lanes];
  const auto corners = std::size_t(paths.dimensions) + 1;
  for (std::size_t i = 0; i < lanes; ++i)
    for (std::size_t k = 0; k < corners; ++k) {
      rows[k][i] = paths.rows[i * corners + k];
      weights[k][i] = paths.weights[i * corners + k];
    }
  for (std::size_t i = 0; i < lanes; ++i)
    responses[i] = 0.0f;
  for (int k = 0; k <= paths.dimensions; ++k)
    addPathsFrom(paths, k, rows, weights, responses);
}

constexpr LatticeEmbedding loops = {embed, selfResponse};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const LatticeEmbedding&
latticeEmbedding(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
