// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_building.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/lattice_building.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

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

constexpr std::size_t keys_together = 64;

// Products of 64 bits, which AVX2 does not have.
template <typename V>
HWY_INLINE V
times(V value, std::uint64_t factor)
{
  const hn::DFromV<V> d;
#if HWY_TARGET == HWY_AVX3
  return hn::Mul(value, hn::Set(d, factor));
#else
  const hn::Repartition<std::uint32_t, decltype(d)> halves;
  const auto lower = hn::BitCast(halves, value);
  const auto upper = hn::BitCast(halves, hn::ShiftRight<32>(value));
  const auto lower_factor = hn::BitCast(halves, hn::Set(d, factor));
  const auto upper_factor = hn::BitCast(halves, hn::Set(d, factor >> 32));
  const auto mixed =
      hn::Add(hn::MulEven(upper, lower_factor), hn::MulEven(lower, upper_factor));
  return hn::Add(hn::MulEven(lower, lower_factor), hn::ShiftLeft<32>(mixed));
#endif
}

void
search(const LatticeTableView& table, const std::uint64_t* keys, std::size_t count,
       std::int32_t* numbers)
{
  const LatticeTableView view = table; // numbers may not overwrite it
  const hn::ScalableTag<std::uint64_t> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<std::uint32_t, decltype(d)> d32;
  const hn::RebindToSigned<decltype(d32)> di32;
  constexpr std::size_t width = hn::MaxLanes(d);
  // Only these targets have instructions that gather; indices of slots are signed.
  const bool gathers = HWY_CAP_GE256 && view.shift > 32;
  const std::size_t whole = gathers ? count - count % width : 0;
  // Some slots, then their keys: what one waits for does not hold up the others.
  for (std::size_t begin = 0; begin < whole; begin += keys_together) {
    const std::size_t end =
        begin + keys_together < whole ? begin + keys_together : whole;
    for (std::size_t i = begin; i < end; i += width) {
      auto hash = times(hn::LoadU(d, keys + i), key_factors[0]);
      hash = times(hn::Xor(hash, hn::ShiftRight<32>(hash)), key_factors[1]);
      const auto slot = hn::TruncateTo(d32, hn::ShiftRightSame(hash, view.shift));
      const auto found = hn::GatherIndex(d32, view.slots, hn::BitCast(di32, slot));
      const auto number = hn::And(found, hn::Set(d32, view.number_mask));
      hn::StoreU(hn::Sub(hn::BitCast(di32, number), hn::Set(di32, 1)), di32,
                 numbers + i);
    }
    for (std::size_t i = begin; i < end; i += width) {
      const auto number = hn::LoadU(di32, numbers + i);
      const auto index = hn::PromoteTo(di, hn::Max(number, hn::Zero(di32)));
      const auto known = hn::GatherIndex(d, view.keys, index);
      const auto other = hn::Xor(known, hn::LoadU(d, keys + i));
      const auto other32 =
          hn::TruncateTo(d32, hn::Or(other, hn::ShiftRight<32>(other)));
      const auto is_it = hn::Eq(hn::BitCast(di32, other32), hn::Zero(di32));
      const auto is_result = hn::Or(is_it, hn::Lt(number, hn::Zero(di32)));
      hn::StoreU(hn::IfThenElse(is_result, number, hn::Set(di32, not_first)), di32,
                 numbers + i);
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    const std::uint32_t found = view.slots[mixKey(keys[i]) >> view.shift];
    const std::uint32_t number = (found & view.number_mask) - (found != 0 ? 1 : 0);
    const bool is_it = view.keys[number] == keys[i];
    numbers[i] = found == 0 ? -1 : is_it ? std::int32_t(number) : not_first;
  }
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

constexpr LatticeBuilding loops = {embed, search, selfResponse};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const LatticeBuilding&
latticeBuilding(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
