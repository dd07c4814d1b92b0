// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_vertices.h"
#include "lattice_table.h"
#include "parallel_loops.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pcl_semantic {

namespace {

using Features = Eigen::Ref<const Eigen::MatrixXf>;

// Keys are sorted into partitions by bits of their hash, for the threads.
constexpr int partition_bits = 6;
constexpr std::size_t partitions = 1 << partition_bits;

// The keys that a chunk touches, numbered in the order of the first touch.
template <typename Key> struct ChunkKeys {
  std::vector<Key> keys;                // sorted by partition
  std::vector<std::uint32_t> indices;   // of each number among the sorted
  std::uint32_t begins[partitions + 1]; // of the partitions
  std::size_t first = 0;                // keys of earlier chunks
};

// Does what findVertices() says, step by step.
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
  run(const Features& features, SimdTier tier)
  {
    embed(features, tier);
    findFirst(tier);
    numberRows();
    findShared();
  }

private:
  // Fills in weights and directions; corner_rows with numbers of keys of the chunk.
  void
  embed(const Features& features, SimdTier tier)
  {
    const auto embed_chunk = [&](std::size_t c, LatticeTable<Key>& table) {
      table.reset(2 * structure_.chunk_points);
      const std::size_t end = endOf(c);
      for (std::size_t i = c * structure_.chunk_points; i < end;
           i += kernels::batch_points)
        embedBatch(features, tier, i, std::min(end, i + kernels::batch_points), table);
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
  embedBatch(const Features& features, SimdTier tier, std::size_t begin,
             std::size_t end, LatticeTable<Key>& table)
  {
    std::int32_t columns[kernels::batch_points];
    for (std::size_t i = 0; i < kernels::batch_points; ++i)
      columns[i] = structure_.columns[std::min(begin + i, end - 1)];
    kernels::LatticeBatch batch;
    kernels::latticeBuilding(tier).embed(structure_.frame, features.data(), columns,
                                         batch);
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

} // namespace

template <typename Key>
LatticeVertices<Key>
findVertices(const Features& features, const LatticeKeyBits& bits, SimdTier tier,
             LatticeStructure& structure)
{
  LatticeVertices<Key> vertices{LatticeKeys<Key>(bits), {}, {}};
  Numbering<Key>(vertices, structure).run(features, tier);
  return vertices;
}

template LatticeVertices<std::uint64_t>
findVertices(const Features&, const LatticeKeyBits&, SimdTier, LatticeStructure&);
template LatticeVertices<LongLatticeKey>
findVertices(const Features&, const LatticeKeyBits&, SimdTier, LatticeStructure&);

} // namespace pcl_semantic
