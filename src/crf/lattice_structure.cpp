// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_structure.h"
#include "core/fail.h"
#include "kernels/lattice_filter.h"
#include "parallel_loops.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcl_semantic {

namespace {

__extension__ typedef unsigned __int128 LongLatticeKey;
using Features = Eigen::Ref<const Eigen::MatrixXf>;

/** \brief How many bits the coordinates of vertices take, from their bounds.
 *
 * The coordinates of a vertex are (d + 1) cell_j + remainder, with one remainder for
 * all; their sum is 0, so cell_0 need not be kept. A key holds the remainder in its
 * lowest bits, then the cells 1 ... d, each with a margin of a few cells, so that the
 * keys of neighbours never carry into each other's bits. */
struct LatticeKeyBits {
  int dimensions = 0;
  int remainder_bits = 0;
  std::int64_t low[kernels::max_dimensions + 1] = {};
  int shift[kernels::max_dimensions + 2] = {}; ///< and, behind the last, all bits
  int bits = 0;                                ///< of a key

  /** \param[in] extents of the features from frame.low */
  LatticeKeyBits(const kernels::LatticeFrame& frame, const double* extents)
      : dimensions(frame.dimensions)
  {
    while ((1 << remainder_bits) < dimensions + 2)
      ++remainder_bits;
    bits = remainder_bits;
    for (int j = 1; j <= dimensions; ++j) {
      double high = 0.0;
      for (int k = j + 1; k <= dimensions; ++k)
        high += frame.scale[k] * extents[k - 1];
      constexpr std::int64_t margin = 4;
      low[j] = -std::int64_t(double(j) * frame.scale[j] * extents[j - 1]) - margin;
      shift[j] = bits;
      const std::int64_t cells = std::int64_t(high) + margin - low[j];
      while ((std::int64_t(1) << (bits - shift[j])) <= cells)
        ++bits;
      shift[j + 1] = bits;
    }
  }
};

/** \brief Arithmetic on keys of 64 or 128 bits. */
template <typename Key> class LatticeKeys {
public:
  explicit LatticeKeys(const LatticeKeyBits& bits) : bits_(bits)
  {
    const int d = bits.dimensions;
    for (int j = 1; j <= d; ++j)
      wrap_ += Key(1) << bits.shift[j];
    wrap_ -= Key(d + 1);
    for (int j = 1; j <= d; ++j)
      cell_masks_[j] = (std::uint64_t(1) << (bits.shift[j + 1] - bits.shift[j])) - 1;
    for (int j = 0; j <= d; ++j)
      steps_[j] = Key(1) - (j > 0 ? Key(1) << bits.shift[j] : Key(0));
  }

  /** \brief The key of vertex 0 of a simplex. */
  Key
  first(const kernels::LatticeBatch& batch, std::size_t lane) const
  {
    Key key = 0;
    for (int j = 1; j <= bits_.dimensions; ++j)
      key += Key(std::uint64_t(batch.cells[j][lane] - bits_.low[j])) << bits_.shift[j];
    return key;
  }

  /** \brief From a vertex to the next one of a simplex. */
  Key
  inSimplex(Key key, int direction) const
  {
    return key + steps_[direction];
  }

  /** \brief The neighbour ahead in a direction. */
  Key
  ahead(Key key, int direction) const
  {
    key += steps_[direction];
    return remainder(key) == bits_.dimensions + 1 ? key + wrap_ : key;
  }

  /** \brief The neighbour back in a direction. */
  Key
  back(Key key, int direction) const
  {
    return (remainder(key) == 0 ? key - wrap_ : key) - steps_[direction];
  }

  int
  remainder(Key key) const
  {
    return int(key & ((Key(1) << bits_.remainder_bits) - 1));
  }

  /** \brief Cell j of 1 ... d, from its lowest. */
  std::uint64_t
  cell(Key key, int j) const
  {
    return std::uint64_t(key >> bits_.shift[j]) & cell_masks_[j];
  }

  /** \brief Mixes all bits of a key into the upper ones, and those into the lower. */
  static std::uint64_t
  hash(Key key)
  {
    if constexpr (sizeof(Key) > 8)
      return kernels::mixKey(std::uint64_t(key) ^
                             std::uint64_t(key >> 64) * 0xD6E8FEB86659FD93u);
    else
      return kernels::mixKey(key);
  }

private:
  LatticeKeyBits bits_;
  Key wrap_ = 0; // from remainder d + 1 to 0
  Key steps_[kernels::max_dimensions + 1];
  std::uint64_t cell_masks_[kernels::max_dimensions + 1] = {};
};

/** \brief What a search in a LatticeTable needs, for registers. */
template <typename Key> struct LatticeSlots {
  const std::uint32_t* slots;
  const Key* keys;
  int shift;
  std::uint32_t number_mask;

  std::uint32_t
  entry(std::uint64_t hash, std::size_t number) const
  {
    return (std::uint32_t(hash) & ~number_mask) | std::uint32_t(number);
  }

  // The slot that has a key or is free for it.
  std::size_t
  search(Key key, std::uint64_t hash) const
  {
    const std::uint32_t tag = std::uint32_t(hash) & ~number_mask;
    std::size_t slot = std::size_t(hash >> shift);
    for (;; slot = (slot + 1) & number_mask) {
      const std::uint32_t found = slots[slot];
      if (found == 0 ||
          ((found & ~number_mask) == tag && keys[(found & number_mask) - 1] == key))
        return slot;
    }
  }
};

/** \brief Numbers keys in the order in which they come; to be used again and again.
 *
 * At most a quarter of the slots is taken, or an eighth. A slot holds a number + 1 in
 * its lower bits, and bits of the hash above them. */
template <typename Key> class LatticeTable {
public:
  explicit LatticeTable(SimdTier tier) : loops_(kernels::latticeBuilding(tier)) {}

  /** \brief Forgets all keys and makes room for some. */
  void
  reset(std::size_t expected)
  {
    size_ = 0;
    keys_.resize(std::max<std::size_t>(expected, 1)); // a search may read the first
    setSlots(4 * expected);
  }

  /** \brief Numbers keys that are all different. */
  template <typename KeyOf>
  void
  fill(std::size_t count, KeyOf&& key_of)
  {
    size_ = count;
    keys_.resize(std::max<std::size_t>(count, 1));
    for (std::size_t i = 0; i < count; ++i) // all at first, as they come from anywhere
      keys_[i] = key_of(i);
    setSlots(8 * count);
    insertAll();
  }

  /** \brief The numbers of keys, which are new or not. */
  void
  insert(const Key* keys, std::size_t count, std::int32_t* numbers)
  {
    if (4 * (size_ + count) > slots_.size()) {
      setSlots(4 * (2 * size_ + count));
      insertAll();
    }
    if (size_ + count > keys_.size())
      keys_.resize(2 * size_ + count);
    findFirst(keys, count, numbers);
    const View view = this->view();
    Key* const known = keys_.data();
    std::size_t size = size_;
    for (std::size_t i = 0; i < count; ++i) {
      if (numbers[i] >= 0)
        continue;
      const std::uint64_t hash = LatticeKeys<Key>::hash(keys[i]);
      std::uint32_t& slot = slots_[view.search(keys[i], hash)];
      if (slot == 0) {
        known[size++] = keys[i];
        slot = view.entry(hash, size);
      }
      numbers[i] = std::int32_t(slot & view.number_mask) - 1;
    }
    size_ = size;
  }

  /** \brief The numbers of keys, -1 if they are unknown. */
  void
  find(const Key* keys, std::size_t count, std::int32_t* numbers) const
  {
    findFirst(keys, count, numbers);
    const View view = this->view();
    for (std::size_t i = 0; i < count; ++i) {
      if (numbers[i] != kernels::not_first)
        continue;
      const std::size_t slot = view.search(keys[i], LatticeKeys<Key>::hash(keys[i]));
      numbers[i] = std::int32_t(view.slots[slot] & view.number_mask) - 1;
    }
  }

  const Key*
  keys() const
  {
    return keys_.data();
  }

  std::size_t
  size() const
  {
    return size_;
  }

private:
  using View = LatticeSlots<Key>;

  // Numbers of the keys that are where they are looked for first.
  void
  findFirst(const Key* keys, std::size_t count, std::int32_t* numbers) const
  {
    if constexpr (sizeof(Key) == sizeof(std::uint64_t))
      loops_.search({slots_.data(), keys_.data(), shift_, number_mask_}, keys, count,
                    numbers);
    else
      std::fill_n(numbers, count, kernels::not_first);
  }

  View
  view() const
  {
    return {slots_.data(), keys_.data(), shift_, number_mask_};
  }

  void
  setSlots(std::size_t least)
  {
    for (shift_ = 64 - 8; (std::size_t(1) << (64 - shift_)) < least;)
      --shift_;
    slots_.assign(std::size_t(1) << (64 - shift_), 0);
    number_mask_ = std::uint32_t(slots_.size() - 1);
  }

  void
  insertAll()
  {
    const View view = this->view();
    for (std::size_t i = 0; i < size_; ++i) {
      const std::uint64_t hash = LatticeKeys<Key>::hash(view.keys[i]);
      std::size_t slot = std::size_t(hash >> view.shift);
      while (slots_[slot] != 0)
        slot = (slot + 1) & view.number_mask;
      slots_[slot] = view.entry(hash, i + 1);
    }
  }

  const kernels::LatticeBuilding& loops_;
  int shift_ = 64;
  std::uint32_t number_mask_ = 0;
  std::vector<std::uint32_t> slots_; // 0 = free
  std::vector<Key> keys_;            // with room for more
  std::size_t size_ = 0;
};

constexpr std::size_t part_size = 8192; // of what threads count at a time
constexpr std::size_t tile_points = 2048;

std::size_t
partsOf(std::size_t count)
{
  return (count + part_size - 1) / part_size;
}

/** \brief Numbers 0 ... count - 1 sorted by their bucket, those of one bucket in their
 * order. */
struct LatticeBuckets {
  AlignedArray<std::int32_t> members;
  std::vector<std::size_t> begins; ///< of each bucket, with an end

  LatticeBuckets(const AlignedArray<std::int32_t>& bucket_of, std::size_t buckets)
      : members(bucket_of.size()), begins(buckets + 1, 0)
  {
    const std::size_t count = bucket_of.size(), parts = partsOf(count);
    // Members of each bucket in each part, then where the first of them goes.
    std::vector<std::size_t> indices(parts * buckets, 0);
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < parts; ++p)
      for (std::size_t i = p * part_size; i < std::min(count, (p + 1) * part_size); ++i)
        ++indices[p * buckets + std::size_t(bucket_of[i])];
    std::size_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
      begins[b] = sum;
      for (std::size_t p = 0; p < parts; ++p) {
        const std::size_t members_here = indices[p * buckets + b];
        indices[p * buckets + b] = sum;
        sum += members_here;
      }
    }
    begins[buckets] = sum;
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < parts; ++p)
      for (std::size_t i = p * part_size; i < std::min(count, (p + 1) * part_size); ++i)
        members[indices[p * buckets + std::size_t(bucket_of[i])]++] = std::int32_t(i);
  }
};

/** \brief The least features and the extents from there to the largest.
 * \throws InvalidParameterException as buildLattice() */
kernels::LatticeFrame
frameOf(const Features& features, double* extents)
{
  const auto d = std::size_t(features.rows());
  if (d < 1 || d > std::size_t(kernels::max_dimensions))
    badParameter("points have ", d, " features, expected 1 to ",
                 kernels::max_dimensions);
  const auto count = std::size_t(features.cols()), parts = partsOf(count);
  Eigen::ArrayXXf lows(d, parts), highs(d, parts);
  bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite)
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t begin = p * part_size, size = std::min(part_size, count - begin);
    const auto part = features.middleCols(Eigen::Index(begin), Eigen::Index(size));
    lows.col(Eigen::Index(p)) = part.rowwise().minCoeff();
    highs.col(Eigen::Index(p)) = part.rowwise().maxCoeff();
    finite = finite && part.allFinite();
  }
  if (!finite)
    badParameter("a feature is not finite");
  kernels::LatticeFrame frame = {};
  frame.dimensions = int(d);
  for (std::size_t k = 0; k < d; ++k) {
    const float low = parts > 0 ? lows.row(Eigen::Index(k)).minCoeff() : 0.0f;
    const float high = parts > 0 ? highs.row(Eigen::Index(k)).maxCoeff() : 0.0f;
    // Features often lie on a grid: with its corner at that of the lattice they would
    // lie between simplices, and rounding would choose.
    const double offset = std::fmod(0.618033988749895 * double(k + 1), 1.0);
    frame.low[k] = double(low) - offset;
    extents[k] = double(high) - frame.low[k];
    frame.scale[k + 1] = std::sqrt(2.0 / (3.0 * double(k + 1) * double(k + 2)));
    constexpr double most = double(1 << 28);
    if (extents[k] > most)
      badParameter("feature ", k, " spans ", extents[k],
                   " deviations, expected at most ", most);
  }
  return frame;
}

/** \brief An order in which points that lie together follow each other: tiles of the
 * first two features (an image's pixels would come row by row), where those of a tile
 * keep their order. */
AlignedArray<std::int32_t>
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
  AlignedArray<std::int32_t> tile_of(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i) {
    const float* const feature = features.col(Eigen::Index(i)).data();
    const std::int32_t row = flat ? tile(feature[1], 1, down) : 0;
    tile_of[i] = row * std::int32_t(across) + tile(feature[0], 0, across);
  }
  return std::move(LatticeBuckets(tile_of, std::size_t(across * down)).members);
}

/** \brief The vertices of a lattice. */
template <typename Key> struct LatticeVertices {
  LatticeKeys<Key> arithmetic;
  AlignedArray<Key> keys; ///< by number

  /** \brief From each corner of a simplex to the next: (d + 1) x 64 for every 64 sorted
   * points. */
  AlignedArray<std::uint8_t> directions;
};

/** \brief Keys are sorted into partitions by bits of their hash, for the threads. */
constexpr int partition_bits = 6;
constexpr std::size_t partitions = 1 << partition_bits;

/** \brief The keys that a chunk touches, numbered in the order of the first touch. */
template <typename Key> struct ChunkKeys {
  std::vector<Key> keys;                // sorted by partition
  std::vector<std::uint32_t> indices;   // of each number among the sorted
  std::uint32_t begins[partitions + 1]; // of the partitions
  std::size_t first = 0;                // keys of earlier chunks
};

/** \brief Finds the simplices of the sorted points and numbers their vertices: fills in
 * everything of a structure with columns, corners and chunk_points but its groups and
 * self-responses. */
template <typename Key> class Numbering {
public:
  Numbering(LatticeVertices<Key>& vertices, LatticeStructure& structure)
      : vertices_(vertices), structure_(structure), chunks_(structure.chunks())
  {
    structure.corner_rows =
        AlignedArray<std::int32_t>(structure.points * structure.corners);
    structure.weights = AlignedArray<float>(structure.points * structure.corners);
    structure.row_ends.resize(batches());
    vertices.directions = AlignedArray<std::uint8_t>(batches() * structure.corners *
                                                     kernels::batch_points);
  }

  void
  run(const Features& features, const kernels::LatticeFrame& frame, SimdTier tier)
  {
    embed(features, frame, tier);
    findFirst(tier);
    numberRows();
    findShared();
  }

private:
  // Fills in weights and directions; corner_rows with numbers of keys of the chunk.
  void
  embed(const Features& features, const kernels::LatticeFrame& frame, SimdTier tier)
  {
    const auto embed_chunk = [&](std::size_t c, LatticeTable<Key>& table) {
      table.reset(2 * structure_.chunk_points);
      const std::size_t end = endOf(c);
      for (std::size_t i = c * structure_.chunk_points; i < end;
           i += kernels::batch_points)
        embedBatch(features, frame, tier, i, std::min(end, i + kernels::batch_points),
                   table);
      sortByPartition(table.keys(), table.size(), chunks_[c]);
    };
    forEachInParallel(
        chunks_.size(), [&] { return LatticeTable<Key>(tier); }, embed_chunk);
  }

  // Finds for every key of every chunk the first chunk that has it.
  void
  findFirst(SimdTier tier)
  {
    std::size_t sum = 0;
    for (ChunkKeys<Key>& chunk : chunks_) {
      chunk.first = sum;
      sum += chunk.keys.size();
    }
    rows_ = AlignedArray<std::int32_t>(sum);
    const auto find_in_partition = [&](std::size_t p, LatticeTable<Key>& table) {
      table.reset(rows_.size() / partitions);
      std::vector<std::int32_t> firsts, numbers;
      for (const ChunkKeys<Key>& chunk : chunks_) {
        const std::uint32_t begin = chunk.begins[p], end = chunk.begins[p + 1];
        numbers.resize(end - begin);
        table.insert(chunk.keys.data() + begin, end - begin, numbers.data());
        for (std::uint32_t k = begin; k < end; ++k) {
          const auto number = std::size_t(numbers[k - begin]);
          const auto here = std::int32_t(chunk.first + k);
          if (number == firsts.size())
            firsts.push_back(here);
          rows_[std::size_t(here)] = firsts[number];
        }
      }
    };
    forEachInParallel(
        partitions, [&] { return LatticeTable<Key>(tier); }, find_in_partition);
  }

  // Numbers the vertices by chunk, and the partial rows behind them.
  void
  numberRows()
  {
    structure_.first_rows.assign(chunks_.size() + 1, 0);
    structure_.first_partials.assign(chunks_.size() + 1, 0);
#pragma omp parallel for schedule(static)
    for (std::size_t c = 0; c < chunks_.size(); ++c)
      for (std::size_t k = 0; k < chunks_[c].keys.size(); ++k)
        ++(isFirst(chunks_[c], k) ? structure_.first_rows
                                  : structure_.first_partials)[c + 1];
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      structure_.first_rows[c + 1] += structure_.first_rows[c];
      structure_.first_partials[c + 1] += structure_.first_partials[c];
    }
    structure_.vertices = structure_.first_rows.back();
    structure_.rows = structure_.vertices + structure_.first_partials.back();
    structure_.represents =
        AlignedArray<std::int32_t>(structure_.first_partials.back());
    vertices_.keys = AlignedArray<Key>(structure_.vertices);
    // First the vertices: the others look up their number, through its negative.
#pragma omp parallel for schedule(static)
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      std::size_t row = structure_.first_rows[c];
      for (const std::uint32_t k : chunks_[c].indices)
        if (isFirst(chunks_[c], k)) {
          vertices_.keys[row] = chunks_[c].keys[k];
          rows_[chunks_[c].first + k] = -1 - std::int32_t(row++);
        }
    }
#pragma omp parallel for schedule(static)
    for (std::size_t c = 0; c < chunks_.size(); ++c)
      writeRows(c);
  }

  // The partial rows of each vertex that has some.
  void
  findShared()
  {
    std::vector<std::uint32_t> counts(structure_.vertices, 0);
    for (std::size_t p = 0; p < structure_.represents.size(); ++p)
      ++counts[std::size_t(structure_.represents[p])];
    structure_.shared_ends.push_back(0);
    for (std::size_t v = 0; v < structure_.vertices; ++v)
      if (counts[v] > 0) {
        const std::uint32_t begin = structure_.shared_ends.back();
        structure_.shared.push_back(std::int32_t(v));
        structure_.shared_ends.push_back(begin + counts[v]);
        counts[v] = begin;
      }
    structure_.shared_rows.resize(structure_.represents.size());
    for (std::size_t p = 0; p < structure_.represents.size(); ++p)
      structure_.shared_rows[counts[std::size_t(structure_.represents[p])]++] =
          std::int32_t(structure_.vertices + p);
  }

  std::size_t
  batches() const
  {
    return (structure_.points + kernels::batch_points - 1) / kernels::batch_points;
  }

  std::size_t
  endOf(std::size_t chunk) const
  {
    return std::min(structure_.points, (chunk + 1) * structure_.chunk_points);
  }

  bool
  isFirst(const ChunkKeys<Key>& chunk, std::size_t k) const
  {
    const std::int32_t first = rows_[chunk.first + k];
    return first < 0 || std::size_t(first) == chunk.first + k;
  }

  void
  embedBatch(const Features& features, const kernels::LatticeFrame& frame,
             SimdTier tier, std::size_t begin, std::size_t end,
             LatticeTable<Key>& table)
  {
    std::int32_t columns[kernels::batch_points];
    for (std::size_t i = 0; i < kernels::batch_points; ++i)
      columns[i] = structure_.columns[std::min(begin + i, end - 1)];
    kernels::LatticeBatch batch;
    kernels::latticeBuilding(tier).embed(frame, features.data(), columns, batch);
    const std::size_t corners = structure_.corners;
    std::uint8_t* const directions = vertices_.directions.data() + begin * corners;
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t i = 0; i < kernels::batch_points; ++i)
        directions[k * kernels::batch_points + i] =
            std::uint8_t(batch.directions[k][i]);
    // Points often lie in the simplex of the one before.
    Key keys[kernels::batch_points * (kernels::max_dimensions + 1)];
    std::int32_t numbers[kernels::batch_points * (kernels::max_dimensions + 1)];
    std::size_t simplex[kernels::batch_points], simplices = 0;
    for (std::size_t i = 0; i < end - begin; ++i) {
      Key key = vertices_.arithmetic.first(batch, i);
      if (i == 0 || key != keys[(simplices - 1) * corners] ||
          !haveSameDirections(batch, i, corners)) {
        for (std::size_t k = 0; k < corners; ++k) {
          keys[simplices * corners + k] = key;
          key = vertices_.arithmetic.inSimplex(key, batch.directions[k][i]);
        }
        ++simplices;
      }
      simplex[i] = simplices - 1;
    }
    table.insert(keys, simplices * corners, numbers);
    for (std::size_t i = 0; i < end - begin; ++i) {
      std::int32_t* const rows = structure_.corner_rows.data() + (begin + i) * corners;
      float* const weights = structure_.weights.data() + (begin + i) * corners;
      for (std::size_t k = 0; k < corners; ++k) {
        rows[k] = numbers[simplex[i] * corners + k];
        weights[k] = batch.weights[k][i];
      }
    }
  }

  // Whether a point lies in the simplex of the one before, if in that of its vertex 0.
  static bool
  haveSameDirections(const kernels::LatticeBatch& batch, std::size_t i,
                     std::size_t corners)
  {
    for (std::size_t k = 0; k < corners; ++k)
      if (batch.directions[k][i] != batch.directions[k][i - 1])
        return false;
    return true;
  }

  static void
  sortByPartition(const Key* keys, std::size_t count, ChunkKeys<Key>& chunk)
  {
    const auto partitionOf = [](Key key) {
      // Not the bits that a table takes: its keys would crowd.
      return std::size_t(LatticeKeys<Key>::hash(key) & (partitions - 1));
    };
    std::fill_n(chunk.begins, partitions + 1, 0);
    for (std::size_t k = 0; k < count; ++k)
      ++chunk.begins[partitionOf(keys[k]) + 1];
    for (std::size_t p = 0; p < partitions; ++p)
      chunk.begins[p + 1] += chunk.begins[p];
    std::uint32_t indices[partitions];
    std::copy_n(chunk.begins, partitions, indices);
    chunk.keys.resize(count);
    chunk.indices.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      chunk.indices[k] = indices[partitionOf(keys[k])]++;
      chunk.keys[chunk.indices[k]] = keys[k];
    }
  }

  // From numbers of keys of a chunk to rows.
  void
  writeRows(std::size_t c)
  {
    const ChunkKeys<Key>& chunk = chunks_[c];
    std::size_t partial = structure_.first_partials[c];
    std::vector<std::int32_t> rows(chunk.keys.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::int32_t first = rows_[chunk.first + chunk.indices[k]];
      if (first < 0) {
        rows[k] = -1 - first;
        continue;
      }
      structure_.represents[partial] = -1 - rows_[std::size_t(first)];
      rows[k] = std::int32_t(structure_.vertices + partial++);
    }
    auto row_end = std::int32_t(structure_.first_rows[c]);
    for (std::size_t i = c * structure_.chunk_points; i < endOf(c); ++i) {
      for (std::size_t k = i * structure_.corners; k < (i + 1) * structure_.corners;
           ++k) {
        std::int32_t& row = structure_.corner_rows[k];
        row = rows[std::size_t(row)];
        if (std::size_t(row) < structure_.vertices)
          row_end = std::max(row_end, row + 1);
      }
      structure_.row_ends[i / kernels::batch_points] = row_end;
    }
  }

  LatticeVertices<Key>& vertices_;
  LatticeStructure& structure_;
  std::vector<ChunkKeys<Key>> chunks_;
  AlignedArray<std::int32_t> rows_; // of all keys of all chunks: first key; -1 - vertex
};

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

/** \brief Finds the runs of vertices in every direction: the groups of a structure. */
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
    const LatticeBuckets sorted(bucket_of, buckets);
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

/** \brief What a one at each point sends back to it: the self-responses of a structure
 * that is complete but for them. */
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

// So many that what points share is found in a chunk, so few that threads find work.
std::size_t
chunkPoints(std::size_t points)
{
  const std::size_t chunk = (points / 64 + 63) / 64 * 64;
  return std::min<std::size_t>(4096, std::max<std::size_t>(256, chunk));
}

template <typename Key>
void
build(const Features& features, const kernels::LatticeFrame& frame,
      const LatticeKeyBits& bits, SimdTier tier, LatticeStructure& structure)
{
  LatticeVertices<Key> vertices{LatticeKeys<Key>(bits), {}, {}};
  Numbering<Key>(vertices, structure).run(features, frame, tier);
  findRuns(vertices, tier, structure);
  findSelfResponses(vertices, tier, structure);
}

} // namespace

LatticeStructure
buildLattice(const Features& features, SimdTier tier)
{
  double extents[kernels::max_dimensions] = {};
  const kernels::LatticeFrame frame = frameOf(features, extents);
  LatticeStructure structure;
  structure.frame = frame;
  structure.points = std::size_t(features.cols());
  structure.corners = std::size_t(features.rows()) + 1;
  structure.chunk_points = chunkPoints(structure.points);
  if (structure.points >
      std::size_t(std::numeric_limits<std::int32_t>::max()) / structure.corners)
    badParameter(structure.points, " points with ", features.rows(),
                 " features are too many for a lattice");
  const LatticeKeyBits bits(frame, extents);
  if (bits.bits > 128)
    badParameter("features span too many deviations in ", features.rows(),
                 " dimensions: keys of lattice vertices would take ", bits.bits,
                 " bits, expected at most 128");
  structure.columns = orderInTiles(features, frame, extents);
  if (bits.bits <= 64)
    build<std::uint64_t>(features, frame, bits, tier, structure);
  else
    build<LongLatticeKey>(features, frame, bits, tier, structure);
  return structure;
}

} // namespace pcl_semantic
