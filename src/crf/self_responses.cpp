// SPDX-License-Identifier: BSD-3-Clause
#include "self_responses.h"
#include "aligned_array.h"
#include "kernels/lattice_filter.h"
#include "lattice_table.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace pcl_semantic {

namespace {

// Beyond that the sets of directions are too many to keep for every vertex.
constexpr int max_dimensions_of_sets = 7;

// Sets of directions as bits of some words, by row (kernels::LatticePaths).
class PathSets {
public:
  explicit PathSets(const LatticeStructure& structure)
      : structure_(structure),
        words_(((std::size_t(1) << structure.corners) + 63) / 64),
        sets_(structure.rows * 2 * words_)
  {
#pragma omp parallel for schedule(static)
    for (std::size_t v = 0; v < 2 * structure.vertices; ++v)
      for (std::size_t w = 0; w < words_; ++w)
        sets_[v * words_ + w] = w == 0 ? 1 : 0;
    // From the last direction to the first, as a path takes the first one first.
    for (auto group = structure.groups.rbegin(); group != structure.groups.rend();
         ++group) {
      const auto first = std::size_t(group->first_direction);
#pragma omp parallel for schedule(dynamic, 1)
      for (std::size_t b = 0; b < group->buckets.size(); ++b)
        for (std::size_t j = group->buckets[b].begins.size(); j-- > 0;)
          words_ == 1 ? addDirection<true>(group->buckets[b], j, first + j)
                      : addDirection<false>(group->buckets[b], j, first + j);
    }
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < structure.represents.size(); ++p)
      std::copy_n(&sets_[std::size_t(structure.represents[p]) * 2 * words_], 2 * words_,
                  &sets_[(structure.vertices + p) * 2 * words_]);
  }

  kernels::LatticePaths
  paths(std::size_t begin, const std::uint8_t* directions) const
  {
    return {int(structure_.corners) - 1,
            words_,
            sets_.data(),
            structure_.corner_rows.data() + begin * structure_.corners,
            structure_.weights.data() + begin * structure_.corners,
            directions + begin * structure_.corners};
  }

private:
  // Adds to every row of a direction the sets of later directions that its neighbours
  // have, with this direction. In place: the neighbour that is read is not changed yet.
  // No branches at the ends of runs, as none could be predicted. \a one_word is words_
  // == 1, known to the compiler.
  template <bool one_word>
  void
  addDirection(const LatticeBucket& bucket, std::size_t j, std::size_t direction)
  {
    const std::size_t words = one_word ? 1 : words_;
    const std::size_t shift = std::size_t(1) << (structure_.corners - 1 - direction);
    const std::size_t first_word = one_word ? 0 : shift / 64;
    const std::size_t end_word = one_word || shift < 64 ? 1 : 2 * first_word;
    const std::int32_t* const steps = bucket.steps.data() + bucket.begins[j];
    std::uint64_t* const sets = sets_.data();
    const auto add = [&](std::int32_t from, bool is_neighbour, std::int32_t to,
                         std::size_t half) {
      const std::uint64_t mask = std::uint64_t(0) - std::uint64_t(is_neighbour);
      const std::uint64_t* const read =
          sets + (std::size_t(from & ~kernels::run_end) * 2 + half) * words;
      std::uint64_t* const write =
          sets + (std::size_t(to & ~kernels::run_end) * 2 + half) * words;
      for (std::size_t w = first_word; w < end_word; ++w)
        write[w] |= (read[w - first_word] << (shift % 64)) & mask;
    };
    for (std::uint32_t t = 0; t < bucket.counts[j]; ++t) {
      const auto later =
          std::size_t(steps[t + kernels::steps_ahead] & ~kernels::run_end);
      __builtin_prefetch(sets + later * 2 * words, 1);
      add(steps[t + 1], steps[t] >= 0, steps[t], 0);
    }
    for (std::uint32_t t = bucket.counts[j]; t-- > 1;)
      add(steps[t - 1], steps[t - 1] >= 0, steps[t], 1);
  }

  const LatticeStructure& structure_;
  std::size_t words_;
  AlignedArray<std::uint64_t> sets_; // a row: those ahead, then those back
};

void
respondBySets(const AlignedArray<std::uint8_t>& directions, SimdTier tier,
              LatticeStructure& structure)
{
  const PathSets sets(structure);
  const kernels::LatticeBuilding& loops = kernels::latticeBuilding(tier);
#pragma omp parallel for schedule(static)
  for (std::size_t begin = 0; begin < structure.points;
       begin += kernels::batch_points) {
    kernels::LatticePaths paths = sets.paths(begin, directions.data());
    const std::size_t count = std::min(kernels::batch_points, structure.points - begin);
    // The last ones are filled up with copies.
    std::int32_t rows[kernels::batch_points * (max_dimensions_of_sets + 1)];
    float weights[kernels::batch_points * (max_dimensions_of_sets + 1)];
    if (count < kernels::batch_points) {
      for (std::size_t i = 0; i < kernels::batch_points * structure.corners; ++i) {
        rows[i] = paths.rows[std::min(i, count * structure.corners - 1)];
        weights[i] = paths.weights[std::min(i, count * structure.corners - 1)];
      }
      paths.rows = rows;
      paths.weights = weights;
    }
    float responses[kernels::batch_points];
    loops.selfResponse(paths, responses);
    for (std::size_t i = 0; i < count; ++i)
      structure.self_responses[std::size_t(structure.columns[begin + i])] =
          responses[i];
  }
}

// Walks every path of every point: for many dimensions, where few of them exist.
template <typename Key> class Walker {
public:
  Walker(const LatticeVertices<Key>& vertices, int corners, SimdTier tier)
      : vertices_(vertices), corners_(corners), table_(tier)
  {
    table_.fill(vertices.keys.size(), [&](std::size_t v) { return vertices.keys[v]; });
  }

  // The weight of stepping, in every direction of a set, ahead (1) or back (-1).
  float
  walk(std::size_t vertex, std::uint32_t set, int sign) const
  {
    Key key = vertices_.keys[vertex];
    float weight = 1.0f;
    for (int j = 0; j < corners_; ++j)
      if (set >> j & 1) {
        key = sign > 0 ? vertices_.arithmetic.ahead(key, j)
                       : vertices_.arithmetic.back(key, j);
        std::int32_t number;
        table_.find(&key, 1, &number);
        if (number < 0)
          return 0.0f;
        weight *= 0.5f;
      }
    return weight;
  }

  float
  respond(const LatticeStructure& structure, std::size_t i) const
  {
    const auto corners = std::size_t(corners_);
    const std::uint8_t* const directions =
        vertices_.directions.data() +
        i / kernels::batch_points * kernels::batch_points * corners +
        i % kernels::batch_points;
    const float* const weights = structure.weights.data() + i * corners;
    const std::uint32_t all = (std::uint32_t(1) << corners) - 1;
    float response = 0.0f;
    for (std::size_t k = 0; k < corners; ++k) {
      auto vertex = std::size_t(structure.corner_rows[i * corners + k]);
      if (vertex >= structure.vertices)
        vertex = std::size_t(structure.represents[vertex - structure.vertices]);
      std::uint32_t set = 0;
      for (std::size_t m = 0; m <= corners; ++m) {
        if (m > 0)
          set |= std::uint32_t(1)
                 << directions[(k + m - 1) % corners * kernels::batch_points];
        const float back = m < corners ? walk(vertex, all ^ set, -1) : 0.0f;
        response +=
            weights[k] * weights[(k + m) % corners] * (walk(vertex, set, 1) + back);
      }
    }
    return response;
  }

private:
  const LatticeVertices<Key>& vertices_;
  int corners_;
  LatticeTable<Key> table_;
};

} // namespace

template <typename Key>
void
findSelfResponses(const LatticeVertices<Key>& vertices, SimdTier tier,
                  LatticeStructure& structure)
{
  structure.self_responses = AlignedArray<float>(structure.points);
  if (int(structure.corners) - 1 <= max_dimensions_of_sets) {
    respondBySets(vertices.directions, tier, structure);
    return;
  }
  const Walker<Key> walker(vertices, int(structure.corners), tier);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t i = 0; i < structure.points; ++i)
    structure.self_responses[std::size_t(structure.columns[i])] =
        walker.respond(structure, i);
}

template void findSelfResponses(const LatticeVertices<std::uint64_t>&, SimdTier,
                                LatticeStructure&);
template void findSelfResponses(const LatticeVertices<LongLatticeKey>&, SimdTier,
                                LatticeStructure&);

} // namespace pcl_semantic
