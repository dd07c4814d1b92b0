// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_runs.h"
#include "kernels/lattice_filter.h"
#include "lattice_table.h"
#include "parallel_loops.h"
#include "sorted_buckets.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

namespace {

// Vertices of a bucket, about: their rows of 16 floats fill a quarter of a 1 MB cache.
constexpr std::size_t bucket_vertices = 4096;
constexpr std::size_t max_buckets = 4096;

// A number that steps in some directions do not change: a sum of the cells of the other
// directions, by factors whose sum is 0. Cell 0 is what the others and the remainder
// leave of 0.
template <typename Key> class SheetNumber {
public:
  SheetNumber(const LatticeKeys<Key>& arithmetic, int dimensions, int begin, int end)
      : arithmetic_(arithmetic), dimensions_(dimensions)
  {
    std::uint64_t sum = 0, factor = 0;
    int last = -1;
    for (int j = 0; j <= dimensions; ++j)
      if (j < begin || j >= end) {
        factor = factor * 0x5851F42D4C957F2Du + 0x14057B7EF767814Fu;
        factors_[j] = factor;
        sum += factor;
        last = j;
      }
    if (last >= 0)
      factors_[last] -= sum;
    for (int j = 1; j <= dimensions; ++j)
      factors_[j] -= factors_[0];
  }

  // 32 bits.
  std::uint64_t
  operator()(Key key) const
  {
    std::uint64_t sum = -factors_[0] * std::uint64_t(arithmetic_.remainder(key));
    for (int j = 1; j <= dimensions_; ++j)
      sum += factors_[j] * arithmetic_.cell(key, j);
    sum = (sum ^ (sum >> 31)) * 0x9E3779B97F4A7C15u;
    return sum >> 32;
  }

private:
  const LatticeKeys<Key>& arithmetic_;
  int dimensions_;
  std::uint64_t factors_[kernels::max_dimensions + 1] = {};
};

// Directions of a group: so few that a sheet is small against the lattice.
int
groupSize(int dimensions)
{
  return dimensions < 6 ? std::max(1, dimensions - 2) : (dimensions + 2) / 2;
}

// Appends the runs of one direction, from the neighbour ahead of every member (-1 =
// none).
void
appendRuns(const std::int32_t* members, const std::vector<std::int32_t>& ahead,
           const std::vector<std::uint8_t>& has_back, std::vector<std::int32_t>& firsts,
           LatticeBucket& bucket)
{
  const std::size_t begin = bucket.steps.size();
  std::size_t count = 0, runs = 0;
  for (std::size_t m = 0; m < ahead.size(); ++m) {
    const bool has_ahead = ahead[m] >= 0;
    firsts[runs] = std::int32_t(m); // no branch: none could be predicted
    runs += has_ahead && !has_back[m + 1];
    count += has_ahead || has_back[m + 1];
  }
  bucket.steps.resize(begin + count + 1);
  std::int32_t* step = bucket.steps.data() + begin;
  for (std::size_t r = 0; r < runs; ++r) {
    std::int32_t here = firsts[r];
    for (; ahead[std::size_t(here)] >= 0; here = ahead[std::size_t(here)])
      *step++ = members[here];
    *step++ = members[here] | kernels::run_end;
  }
  *step = count > 0 ? step[-1] : 0; // a loop looks one step ahead
  bucket.begins.push_back(std::uint32_t(begin));
  bucket.counts.push_back(std::uint32_t(count));
}

template <typename Key>
LatticeBucket
makeBucket(const LatticeVertices<Key>& vertices, const std::int32_t* members,
           std::size_t count, int begin, int end, LatticeTable<Key>& table)
{
  table.fill(count,
             [&](std::size_t m) { return vertices.keys[std::size_t(members[m])]; });
  LatticeBucket bucket;
  std::vector<Key> keys(count);
  std::vector<std::int32_t> ahead(count), firsts(count);
  std::vector<std::uint8_t> has_back(count + 1); // of member - 1
  for (int j = begin; j < end; ++j) {
    std::fill(has_back.begin(), has_back.end(), 0);
    for (std::size_t m = 0; m < count; ++m)
      keys[m] = vertices.arithmetic.ahead(table.keys()[m], j);
    table.find(keys.data(), count, ahead.data());
    for (std::size_t m = 0; m < count; ++m)
      has_back[std::size_t(ahead[m] + 1)] = 1; // of 0 = none, no branch
    appendRuns(members, ahead, has_back, firsts, bucket);
  }
  bucket.steps.resize(bucket.steps.size() + kernels::steps_ahead, bucket.steps.back());
  bucket.steps.shrink_to_fit();
  return bucket;
}

} // namespace

template <typename Key>
void
findRuns(const LatticeVertices<Key>& vertices, SimdTier tier,
         LatticeStructure& structure)
{
  const int corners = int(structure.corners), size = groupSize(corners - 1);
  const std::size_t buckets =
      std::min(max_buckets, structure.vertices / bucket_vertices + 1);
  AlignedArray<std::int32_t> bucket_of(structure.vertices);
  for (int begin = 0; begin < corners; begin += size) {
    const int end = std::min(corners, begin + size);
    const SheetNumber<Key> sheet(vertices.arithmetic, corners - 1, begin, end);
#pragma omp parallel for schedule(static)
    for (std::size_t v = 0; v < structure.vertices; ++v)
      bucket_of[v] = std::int32_t(sheet(vertices.keys[v]) * buckets >> 32);
    const SortedBuckets sorted(bucket_of, buckets);
    structure.groups.push_back({begin, std::vector<LatticeBucket>(buckets)});
    const auto make_bucket = [&](std::size_t b, LatticeTable<Key>& table) {
      structure.groups.back().buckets[b] =
          makeBucket(vertices, sorted.members.data() + sorted.begins[b],
                     sorted.begins[b + 1] - sorted.begins[b], begin, end, table);
    };
    forEachInParallel(
        buckets, [&] { return LatticeTable<Key>(tier); }, make_bucket);
  }
}

template void findRuns(const LatticeVertices<std::uint64_t>&, SimdTier,
                       LatticeStructure&);
template void findRuns(const LatticeVertices<LongLatticeKey>&, SimdTier,
                       LatticeStructure&);

} // namespace pcl_semantic
