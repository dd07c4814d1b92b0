// SPDX-License-Identifier: BSD-3-Clause
#include "permutohedral_lattice.h"
#include "core/fail.h"
#include "lattice_keys.h"
#include "parallel_loops.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

using Features = Eigen::Ref<const Eigen::MatrixXf>;

constexpr std::size_t tile_points = 2048;
// Approximate vertices per bucket: their rows of 16 floats fill a quarter of a 1 MB
// cache.
constexpr std::size_t bucket_vertices = 4096;

/** \brief The minimum of the features and their extents.
 * \param[in] given_lows of the features of a larger set; empty = of these
 * \throws InvalidParameterException as PermutohedralLattice */
kernels::LatticeFrame
frameOf(const Features& features, const Eigen::VectorXf& given_lows, double* extents)
{
  const Eigen::Index d = features.rows();
  if (d < 1 || d > kernels::max_dimensions)
    badParameter("points have ", d, " features, expected 1 to ",
                 kernels::max_dimensions);
  if (!features.allFinite())
    badParameter("a feature is not finite");
  Eigen::ArrayXf lows = Eigen::ArrayXf::Zero(d), highs = lows;
#pragma omp parallel for schedule(static)
  for (Eigen::Index k = 0; k < d; ++k)
    if (features.cols() > 0) {
      lows[k] = features.row(k).minCoeff();
      highs[k] = features.row(k).maxCoeff();
    }
  kernels::LatticeFrame frame = {};
  frame.dimensions = int(d);
  for (int k = 0; k < frame.dimensions; ++k) {
    // Features are often on a grid. If its corner were the lattice's corner, they would
    // lie between simplices, and rounding would select one.
    const double offset = std::fmod(0.618033988749895 * double(k + 1), 1.0);
    frame.scale[k + 1] = std::sqrt(2.0 / (3.0 * double(k + 1) * double(k + 2)));
    frame.low[k] = double(lows[k]) - offset;
    if (given_lows.size() > 0) {
      // The lattice is the same after whole periods of 1 / scale along a feature.
      const double given = double(given_lows[k]) - offset;
      const double periods = std::floor((frame.low[k] - given) * frame.scale[k + 1]);
      frame.low[k] = given + periods / frame.scale[k + 1];
    }
    extents[k] = double(highs[k]) - frame.low[k];
    constexpr double most = double(1 << 28);
    if (extents[k] > most)
      badParameter("feature ", k, " spans ", extents[k],
                   " deviations, expected at most ", most);
  }
  return frame;
}

/** \brief Numbers 0 ... N - 1 sorted by bucket, stable within a bucket.
 * \param[out] begins of each bucket, with an end */
std::vector<std::int32_t>
sortedByBucket(const std::vector<std::int32_t>& bucket_of, std::size_t buckets,
               std::vector<std::size_t>& begins)
{
  begins.assign(buckets + 1, 0);
  for (const std::int32_t bucket : bucket_of)
    ++begins[std::size_t(bucket) + 1];
  for (std::size_t b = 0; b < buckets; ++b)
    begins[b + 1] += begins[b];
  std::vector<std::size_t> next(begins);
  std::vector<std::int32_t> sorted(bucket_of.size());
  for (std::size_t i = 0; i < bucket_of.size(); ++i)
    sorted[next[std::size_t(bucket_of[i])]++] = std::int32_t(i);
  return sorted;
}

/** \brief An order in which neighbouring points are consecutive: by tiles of the first
 * two features (pixels of an image would otherwise come row by row), stable within a
 * tile. */
std::vector<std::int32_t>
orderInTiles(const Features& features, const kernels::LatticeFrame& frame,
             const double* extents)
{
  const auto count = std::size_t(features.cols());
  const double tiles = std::max(1.0, double(count) / double(tile_points));
  const bool flat = frame.dimensions > 1;
  const double area = extents[0] * (flat ? extents[1] : 1.0);
  const double edge = flat ? std::sqrt(area / tiles) : area / tiles;
  const auto along = [&](int k) {
    const double most = double(count / tile_points + 1);
    return edge > 0.0 ? std::clamp(std::ceil(extents[k] / edge), 1.0, most) : 1.0;
  };
  const double across = along(0), down = flat ? along(1) : 1.0;
  const auto tile = [&](float feature, int k, double number) {
    const double index = (double(feature) - frame.low[k]) / extents[k] * number;
    return extents[k] > 0.0 ? std::min(std::int32_t(index), std::int32_t(number) - 1)
                            : 0;
  };
  std::vector<std::int32_t> tile_of(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i) {
    const float* const feature = features.col(Eigen::Index(i)).data();
    const std::int32_t row = flat ? tile(feature[1], 1, down) : 0;
    tile_of[i] = row * std::int32_t(across) + tile(feature[0], 0, across);
  }
  std::vector<std::size_t> begins;
  return sortedByBucket(tile_of, std::size_t(across * down), begins);
}

// A compromise: large chunks share more vertices, small chunks balance the threads.
std::size_t
chunkPoints(std::size_t points)
{
  const std::size_t chunk = (points / 64 + 63) / 64 * 64;
  return std::min<std::size_t>(4096, std::max<std::size_t>(256, chunk));
}

/** \brief Builds a lattice from its frame and columns, step by step. */
template <typename Key> class Builder {
public:
  Builder(const LatticeKeys<Key>& keys, SimdTier tier, PermutohedralLattice& lattice)
      : keys_(keys), embed_(kernels::latticeEmbedding(tier)), lattice_(lattice),
        chunk_numbers_(lattice.chunks())
  {}

  void
  run(const Features& features)
  {
    embed(features);
    writeRows();
    sortPartials();
    findRuns();
    if (lattice_.corners <= max_corners_of_sets)
      findPaths();
    lattice_.self_responses.resize(Eigen::Index(lattice_.points));
#pragma omp parallel for schedule(dynamic, batch)
    for (std::size_t i = 0; i < lattice_.points; ++i)
      lattice_.self_responses[lattice_.columns[i]] = respond(i);
  }

private:
  // Up to this, all sets of directions can be stored for every vertex.
  static constexpr std::size_t max_corners_of_sets = 8;
  static constexpr std::size_t batch = kernels::batch_points;

  std::size_t
  endOf(std::size_t chunk) const
  {
    return std::min(lattice_.points, (chunk + 1) * lattice_.chunk_points);
  }

  // Computes weights, directions and corner_rows (with the chunk's key numbers), then
  // numbers the vertices chunk by chunk.
  void
  embed(const Features& features)
  {
    const std::size_t corners = lattice_.corners, chunks = lattice_.chunks();
    lattice_.corner_rows = AlignedArray<std::int32_t>(lattice_.points * corners);
    lattice_.weights = AlignedArray<float>(lattice_.points * corners);
    directions_ = AlignedArray<std::uint8_t>(lattice_.points * corners);
    std::vector<std::vector<Key>> chunk_keys(chunks);
    forEachInParallel(
        chunks, [] { return LatticeTable<Key>(); },
        [&](std::size_t c, LatticeTable<Key>& table) {
          table.reset(4 * lattice_.chunk_points);
          for (std::size_t i = c * lattice_.chunk_points; i < endOf(c); i += batch)
            embedBatch(features, i, std::min(endOf(c), i + batch), table);
          chunk_keys[c] = table.keys();
        });
    std::size_t sum = 0;
    for (const std::vector<Key>& keys : chunk_keys)
      sum += keys.size();
    vertices_.reset(sum);
    lattice_.first_rows.push_back(0);
    lattice_.first_partials.push_back(0);
    for (std::size_t c = 0; c < chunks; ++c) {
      for (const Key& key : std::vector<Key>(std::move(chunk_keys[c]))) {
        const std::size_t known = vertices_.keys().size();
        const std::int32_t vertex = vertices_.insert(key);
        const bool is_new = std::size_t(vertex) == known;
        chunk_numbers_[c].push_back(
            is_new ? vertex : -1 - std::int32_t(lattice_.represents.size()));
        if (!is_new)
          lattice_.represents.push_back(vertex);
      }
      lattice_.first_rows.push_back(vertices_.keys().size());
      lattice_.first_partials.push_back(lattice_.represents.size());
    }
    lattice_.vertices = vertices_.keys().size();
    lattice_.rows = lattice_.vertices + lattice_.represents.size();
  }

  void
  embedBatch(const Features& features, std::size_t begin, std::size_t end,
             LatticeTable<Key>& table)
  {
    std::int32_t columns[batch];
    for (std::size_t i = 0; i < batch; ++i)
      columns[i] = lattice_.columns[std::min(begin + i, end - 1)];
    kernels::LatticeBatch simplices;
    embed_(lattice_.frame, features.data(), columns, simplices);
    const std::size_t corners = lattice_.corners;
    // Consecutive points often share vertices. No key has all bits set.
    Key before[kernels::max_dimensions + 1];
    std::int32_t numbers[kernels::max_dimensions + 1];
    std::fill_n(before, corners, ~Key(0));
    for (std::size_t i = 0; i < end - begin; ++i) {
      Key key = keys_.first(simplices, i);
      for (std::size_t k = 0; k < corners; ++k) {
        if (key != before[k]) {
          before[k] = key;
          numbers[k] = table.insert(key);
        }
        lattice_.corner_rows[(begin + i) * corners + k] = numbers[k];
        lattice_.weights[(begin + i) * corners + k] = simplices.weights[k][i];
        directions_[(begin + i) * corners + k] =
            std::uint8_t(simplices.directions[k][i]);
        key = keys_.ahead(key, simplices.directions[k][i]);
      }
    }
  }

  // Converts key numbers of a chunk to rows.
  void
  writeRows()
  {
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t c = 0; c < chunk_numbers_.size(); ++c) {
      for (std::int32_t& number : chunk_numbers_[c])
        if (number < 0)
          number = std::int32_t(lattice_.vertices) - 1 - number;
      const std::size_t begin = c * lattice_.chunk_points * lattice_.corners;
      for (std::size_t k = begin; k < endOf(c) * lattice_.corners; ++k)
        lattice_.corner_rows[k] =
            chunk_numbers_[c][std::size_t(lattice_.corner_rows[k])];
    }
  }

  void
  sortPartials()
  {
    std::vector<std::int32_t> part_of(lattice_.represents);
    for (std::int32_t& part : part_of)
      part /= std::int32_t(lattice_.part_rows);
    const std::size_t parts =
        (lattice_.vertices + lattice_.part_rows - 1) / lattice_.part_rows;
    lattice_.merged = sortedByBucket(part_of, parts, lattice_.merged_begins);
  }

  void
  findRuns()
  {
    // Directions per group: so few that a sheet is small compared with the lattice.
    const int corners = int(lattice_.corners), d = corners - 1;
    const int size = d < 6 ? std::max(1, d - 2) : (d + 2) / 2;
    const std::size_t buckets = lattice_.vertices / bucket_vertices + 1;
    std::vector<std::int32_t> bucket_of(lattice_.vertices);
    for (int first = 0; first < corners; first += size) {
      const int end = std::min(corners, first + size);
#pragma omp parallel for schedule(static)
      for (std::size_t v = 0; v < lattice_.vertices; ++v)
        bucket_of[v] =
            std::int32_t(keys_.sheet(vertices_.keys()[v], first, end) * buckets >> 32);
      std::vector<std::size_t> begins;
      const std::vector<std::int32_t> sorted =
          sortedByBucket(bucket_of, buckets, begins);
      lattice_.groups.push_back(
          {std::size_t(first), std::vector<PermutohedralLattice::Bucket>(buckets)});
      forEachInParallel(
          buckets, [] { return LatticeTable<Key>(); },
          [&](std::size_t b, LatticeTable<Key>& table) {
            lattice_.groups.back().buckets[b] =
                makeBucket(sorted.data() + begins[b], begins[b + 1] - begins[b], first,
                           end, table);
          });
    }
  }

  PermutohedralLattice::Bucket
  makeBucket(const std::int32_t* members, std::size_t count, int first, int end,
             LatticeTable<Key>& table) const
  {
    std::vector<Key> keys(count); // initially all, because they are in no order
    for (std::size_t m = 0; m < count; ++m)
      keys[m] = vertices_.keys()[std::size_t(members[m])];
    table.reset(4 * count); // most look-ups end at the first slot
    for (const Key& key : keys)
      table.insert(key);
    PermutohedralLattice::Bucket bucket;
    bucket.begins.push_back(0);
    std::vector<std::int32_t> ahead(count);
    std::vector<std::uint8_t> has_back(count + 1); // of member - 1
    for (int j = first; j < end; ++j) {
      std::fill(has_back.begin(), has_back.end(), 0);
      for (std::size_t m = 0; m < count; ++m) {
        ahead[m] = table.find(keys_.ahead(keys[m], j));
        has_back[std::size_t(ahead[m] + 1)] = 1; // of 0 = none; avoids a branch
      }
      appendRuns(members, ahead, has_back, bucket);
    }
    bucket.steps.resize(bucket.steps.size() + kernels::steps_ahead, 0);
    bucket.steps.shrink_to_fit();
    return bucket;
  }

  // Appends the runs of one direction, from the neighbour ahead of every member (-1 =
  // none).
  static void
  appendRuns(const std::int32_t* members, const std::vector<std::int32_t>& ahead,
             const std::vector<std::uint8_t>& has_back,
             PermutohedralLattice::Bucket& bucket)
  {
    for (std::size_t m = 0; m < ahead.size(); ++m) {
      if (ahead[m] < 0 || has_back[m + 1])
        continue;
      auto here = std::int32_t(m);
      for (; ahead[std::size_t(here)] >= 0; here = ahead[std::size_t(here)])
        bucket.steps.push_back(members[here]);
      bucket.steps.push_back(members[here] | kernels::run_end);
    }
    const bool is_empty = bucket.steps.size() == bucket.begins.back();
    bucket.steps.push_back(is_empty ? 0 : bucket.steps.back());
    bucket.begins.push_back(bucket.steps.size());
  }

  // Finds the paths from every vertex. Bit S of the first (second) half of its sets is
  // 1 if the path from there exists that steps ahead (back) in every direction j of the
  // set S, in their order; S = sum of 2^(d - j).
  void
  findPaths()
  {
    words_ = ((std::size_t(1) << lattice_.corners) + 63) / 64;
    sets_ = AlignedArray<std::uint64_t>(lattice_.vertices * 2 * words_);
#pragma omp parallel for schedule(static)
    for (std::size_t v = 0; v < 2 * lattice_.vertices; ++v)
      for (std::size_t w = 0; w < words_; ++w)
        sets_[v * words_ + w] = w == 0 ? 1 : 0;
    // From the last direction to the first, because a path starts with the first one.
    for (auto group = lattice_.groups.rbegin(); group != lattice_.groups.rend();
         ++group) {
#pragma omp parallel for schedule(dynamic, 1)
      for (std::size_t b = 0; b < group->buckets.size(); ++b) {
        const PermutohedralLattice::Bucket& bucket = group->buckets[b];
        for (std::size_t j = bucket.begins.size() - 1; j-- > 0;)
          addDirection(bucket.steps.data() + bucket.begins[j],
                       bucket.begins[j + 1] - bucket.begins[j] - 1,
                       group->first_direction + j);
      }
    }
  }

  // Adds to every row of a direction the sets of later directions of its neighbours,
  // extended by this direction. Works in place: the neighbour that is read has not
  // changed yet. Without branches at the ends of runs, which would be mispredicted.
  void
  addDirection(const std::int32_t* steps, std::size_t count, std::size_t direction)
  {
    const std::size_t words = words_;
    const std::size_t shift = std::size_t(1) << (lattice_.corners - 1 - direction);
    const std::size_t first = shift / 64, end = shift < 64 ? 1 : 2 * first;
    std::uint64_t* const sets = sets_.data();
    const auto setsOf = [&](std::int32_t step, std::size_t half) {
      return sets + (std::size_t(step & ~kernels::run_end) * 2 + half) * words;
    };
    const auto add = [&](std::int32_t from, bool is_neighbour, std::int32_t to,
                         std::size_t half) {
      const std::uint64_t mask = std::uint64_t(0) - std::uint64_t(is_neighbour);
      const std::uint64_t* const read = setsOf(from, half);
      std::uint64_t* const write = setsOf(to, half);
      for (std::size_t w = first; w < end; ++w)
        write[w] |= (read[w - first] << (shift % 64)) & mask;
    };
    for (std::size_t t = 0; t < count; ++t) {
      __builtin_prefetch(setsOf(steps[t + kernels::steps_ahead], 0), 1);
      add(steps[t + 1], steps[t] >= 0, steps[t], 0);
    }
    for (std::size_t t = count; t-- > 1;)
      add(steps[t - 1], steps[t - 1] >= 0, steps[t], 1);
  }

  // A value moves from vertex k of a simplex to vertex k + m (modulo d + 1) by one step
  // ahead in m directions, or one step back in the d + 1 - m others, each of weight
  // 1/2.
  float
  respond(std::size_t i) const
  {
    const std::size_t corners = lattice_.corners;
    const float* const weights = lattice_.weights.data() + i * corners;
    const std::uint32_t all = (std::uint32_t(1) << corners) - 1;
    std::uint32_t steps[kernels::max_dimensions + 1]; // of the direction, as a set
    for (std::size_t k = 0; k < corners; ++k)
      steps[k] = std::uint32_t(1) << (corners - 1 - directions_[i * corners + k]);
    float response = 0.0f;
    for (std::size_t k = 0; k < corners; ++k) {
      auto vertex = std::size_t(lattice_.corner_rows[i * corners + k]);
      if (vertex >= lattice_.vertices)
        vertex = std::size_t(lattice_.represents[vertex - lattice_.vertices]);
      std::uint32_t set = 0;
      float weight_ahead = 1.0f, weight_back = 1.0f / float(all + 1);
      for (std::size_t m = 0, end = k; m < corners; ++m) {
        const float from_ahead = weight_ahead * float(paths(vertex, set, 0));
        const float from_back = weight_back * float(paths(vertex, all ^ set, 1));
        response += weights[k] * weights[end] * (from_ahead + from_back);
        set |= steps[end];
        end = end + 1 < corners ? end + 1 : 0;
        weight_ahead *= 0.5f;
        weight_back *= 2.0f;
      }
      response += weights[k] * weights[k] * // the empty path counts once
                  (weight_ahead * float(paths(vertex, all, 0)));
    }
    return response;
  }

  // 1 if the path from a vertex exists (half 1: back), else 0. In high dimensions there
  // are too many sets to store and few paths, so the path is followed instead.
  std::int32_t
  paths(std::size_t vertex, std::uint32_t set, std::size_t half) const
  {
    if (words_ > 0)
      return std::int32_t(sets_[(vertex * 2 + half) * words_ + set / 64] >> set % 64) &
             1;
    Key key = vertices_.keys()[vertex];
    const int d = int(lattice_.corners) - 1;
    for (int j = 0; j <= d; ++j)
      if (set >> (d - j) & 1) {
        key = half > 0 ? keys_.back(key, j) : keys_.ahead(key, j);
        if (vertices_.find(key) < 0)
          return 0;
      }
    return 1;
  }

  const LatticeKeys<Key> keys_;
  const kernels::LatticeEmbedding embed_;
  PermutohedralLattice& lattice_;
  LatticeTable<Key> vertices_;
  // By key number in its chunk: its vertex, or -1 minus its partial row.
  std::vector<std::vector<std::int32_t>> chunk_numbers_;
  AlignedArray<std::uint8_t> directions_; // from each corner to the next, d + 1 per
                                          // point
  AlignedArray<std::uint64_t> sets_;      // of directions, by vertex
  std::size_t words_ = 0;                 // of half of the sets of a vertex
};

} // namespace

PermutohedralLattice::PermutohedralLattice(const Features& features, SimdTier tier,
                                           const Eigen::VectorXf& lows)
{
  double extents[kernels::max_dimensions] = {};
  frame = frameOf(features, lows, extents);
  points = std::size_t(features.cols());
  corners = std::size_t(features.rows()) + 1;
  chunk_points = chunkPoints(points);
  if (points > std::size_t(std::numeric_limits<std::int32_t>::max()) / corners)
    badParameter(points, " points with ", features.rows(),
                 " features are too many for a lattice");
  const LatticeKeys<std::uint64_t> keys(frame, extents);
  if (keys.bits() > 128)
    badParameter("features span too many deviations in ", features.rows(),
                 " dimensions: keys of lattice vertices would take ", keys.bits(),
                 " bits, expected at most 128");
  columns = orderInTiles(features, frame, extents);
  if (keys.bits() <= 64)
    Builder<std::uint64_t>(keys, tier, *this).run(features);
  else
    Builder<LongLatticeKey>(LatticeKeys<LongLatticeKey>(frame, extents), tier, *this)
        .run(features);
}

float
PermutohedralLattice::gain() const
{
  // The taps sum to 2 in each of d + 1 directions; a vertex represents the volume
  // (3/2)^(d/2) / (d + 1)^(1/2) of the feature space.
  const double d = frame.dimensions, pi = 3.14159265358979323846;
  return float(std::pow(4.0 * pi / 3.0, d / 2.0) * std::sqrt(d + 1.0) /
               std::exp2(d + 1.0));
}

} // namespace pcl_semantic
