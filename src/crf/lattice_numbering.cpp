// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_numbering.h"

#include "lattice_chunk_keys.h"
#include "lattice_table.h"

#include <pcl_semantic/core/parallel_guard.h>

namespace pcl_semantic {

namespace {

template <typename Key> class Numbering {
public:
  Numbering(LatticeVertices<Key>& vertices, LatticeStructure& structure)
      : vertices_(vertices), structure_(structure), chunks_(structure.pointChunks())
  {
    structure.corner_rows =
        LatticeArray<std::int32_t>(structure.points * structure.corners);
    structure.weights = LatticeArray<float>(structure.points * structure.corners);
    structure.row_ends.resize(batches());
    vertices.directions = LatticeArray<std::uint8_t>(batches() * structure.corners *
                                                     kernels::batch_points);
  }

  // Fills in weights and directions; corner_rows with numbers of keys of the chunk.
  void
  embed(const LatticeFeatures& features, const kernels::LatticeFrame& frame,
        SimdTier tier)
  {
    ParallelGuard guard;
#pragma omp parallel
    guard.run([&] {
      LatticeTable<Key> table(tier);
#pragma omp for schedule(dynamic, 1) nowait
      for (std::size_t c = 0; c < chunks_.size(); ++c)
        guard.run([&] {
          table.reset(2 * structure_.chunk_points);
          const std::size_t end = endOf(c);
          for (std::size_t i = c * structure_.chunk_points; i < end;
               i += kernels::batch_points)
            embedBatch(features, frame, tier, i,
                       std::min(end, i + kernels::batch_points), table);
          sortByPartition(table.keys(), table.size(), chunks_[c]);
        });
    });
    guard.rethrow();
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
    rows_ = LatticeArray<std::int32_t>(sum);
    ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t p = 0; p < partitions; ++p)
      guard.run([&] {
        LatticeTable<Key> table(tier);
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
      });
    guard.rethrow();
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
        LatticeArray<std::int32_t>(structure_.first_partials.back());
    vertices_.keys = LatticeArray<Key>(structure_.vertices);
    // First the vertices: the others look up their number, through its negative.
#pragma omp parallel for schedule(static)
    for (std::size_t c = 0; c < chunks_.size(); ++c) {
      std::size_t row = structure_.first_rows[c];
      for (const std::uint32_t k : chunks_[c].places)
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

private:
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
  embedBatch(const LatticeFeatures& features, const kernels::LatticeFrame& frame,
             SimdTier tier, std::size_t begin, std::size_t end,
             LatticeTable<Key>& table)
  {
    std::int32_t columns[kernels::batch_points];
    for (std::size_t i = 0; i < kernels::batch_points; ++i)
      columns[i] = (*structure_.columns)[std::min(begin + i, end - 1)];
    kernels::LatticeBatch batch;
    kernels::latticeEmbedding(tier).embed(frame, features.data(), columns, batch);
    const std::size_t corners = structure_.corners;
    std::uint8_t* const directions = vertices_.directions.data() + begin * corners;
    for (std::size_t k = 0; k < corners; ++k)
      for (std::size_t i = 0; i < kernels::batch_points; ++i)
        directions[k * kernels::batch_points + i] =
            std::uint8_t(batch.directions[k][i]);
    // Points often lie in the simplex of the one before.
    Key keys[kernels::batch_points * (kernels::most_dimensions + 1)];
    std::int32_t numbers[kernels::batch_points * (kernels::most_dimensions + 1)];
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
    std::uint32_t places[partitions];
    std::copy_n(chunk.begins, partitions, places);
    chunk.keys.resize(count);
    chunk.places.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      chunk.places[k] = places[partitionOf(keys[k])]++;
      chunk.keys[chunk.places[k]] = keys[k];
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
      const std::int32_t first = rows_[chunk.first + chunk.places[k]];
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
  LatticeArray<std::int32_t> rows_; // of all keys of all chunks: first key; -1 - vertex
};

} // namespace

template <typename Key>
LatticeVertices<Key>
numberVertices(const LatticeFeatures& features, const kernels::LatticeFrame& frame,
               const LatticeKeyBits& bits, SimdTier tier, LatticeStructure& structure)
{
  LatticeVertices<Key> vertices{LatticeKeys<Key>(bits), {}, {}};
  Numbering numbering(vertices, structure);
  numbering.embed(features, frame, tier);
  numbering.findFirst(tier);
  numbering.numberRows();
  numbering.findShared();
  return vertices;
}

template LatticeVertices<std::uint64_t> numberVertices(const LatticeFeatures&,
                                                       const kernels::LatticeFrame&,
                                                       const LatticeKeyBits&, SimdTier,
                                                       LatticeStructure&);
template LatticeVertices<LongLatticeKey> numberVertices(const LatticeFeatures&,
                                                        const kernels::LatticeFrame&,
                                                        const LatticeKeyBits&, SimdTier,
                                                        LatticeStructure&);

} // namespace pcl_semantic
