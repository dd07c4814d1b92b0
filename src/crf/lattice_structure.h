// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "kernels/lattice_embedding.h"

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pcl_semantic {

/** \brief A fixed number of plain values that nobody has written yet: the threads that
 * fill it also fetch its pages, which a vector would do on one of them. */
template <typename T> class LatticeArray {
  static_assert(std::is_trivial_v<T>);

public:
  LatticeArray() = default;

  explicit LatticeArray(std::size_t size) : size_(size)
  {
    // Large arrays are read in a random order: huge pages, where there are any.
    constexpr std::size_t line = 64, huge_page = std::size_t(1) << 21;
    const std::size_t bytes = size * sizeof(T);
    const std::size_t unit = bytes >= 2 * huge_page ? huge_page : line;
    if (bytes > std::size_t(-1) / 2)
      throw std::bad_alloc();
    if (bytes > 0) {
      values_.reset(
          static_cast<T*>(std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit)));
      if (!values_)
        throw std::bad_alloc();
    }
#ifdef __linux__
    if (unit == huge_page)
      madvise(values_.get(), bytes, MADV_HUGEPAGE);
#endif
  }

  std::size_t
  size() const
  {
    return size_;
  }

  std::size_t
  bytes() const
  {
    return size_ * sizeof(T);
  }

  T*
  data()
  {
    return values_.get();
  }

  const T*
  data() const
  {
    return values_.get();
  }

  T&
  operator[](std::size_t i)
  {
    return values_.get()[i];
  }

  const T&
  operator[](std::size_t i) const
  {
    return values_.get()[i];
  }

private:
  struct Free {
    void
    operator()(T* values) const
    {
      std::free(values);
    }
  };

  std::size_t size_ = 0;
  std::unique_ptr<T, Free> values_;
};

using LatticeFeatures = Eigen::Ref<const Eigen::MatrixXf>;

/** \brief The points (by column) in the order in which a lattice takes them. */
using LatticeOrder = std::shared_ptr<const LatticeArray<std::int32_t>>;

/** \brief The runs of some vertices, in each direction of a group: their rows one after
 * the other, the last of a run marked. */
struct LatticeBucket {
  std::vector<std::int32_t> steps;
  std::vector<std::uint32_t> begins; ///< of each direction
  std::vector<std::uint32_t> counts; ///< of each direction
};

/** \brief Directions that are blurred one after the other without a look at more than a
 * bucket of vertices, which stays in the fast cache: a bucket holds whole sheets, sets
 * of all vertices that can be reached by steps in these directions. */
struct LatticeGroup {
  int first_direction = 0;
  std::vector<LatticeBucket> buckets;
};

/** \brief A lattice around points. The points are sorted into chunks that lie together.
 * Vertices are numbered by the chunk that touches them first, so that the sums of a
 * chunk go to rows of its own: those of its vertices, and partial rows (numbered after
 * the vertices) for those of earlier chunks. No number depends on the threads. */
struct LatticeStructure {
  kernels::LatticeFrame frame = {};
  std::size_t points = 0;
  std::size_t corners = 0; ///< of a simplex, d + 1
  std::size_t vertices = 0;
  std::size_t rows = 0; ///< vertices and partial rows
  std::size_t chunk_points = 0;

  /** \brief Chunks that the points fill. */
  std::size_t
  pointChunks() const
  {
    return (points + chunk_points - 1) / chunk_points;
  }

  LatticeOrder columns; ///< of the sorted points
  LatticeArray<std::int32_t> corner_rows;
  LatticeArray<float> weights;
  std::vector<std::int32_t> row_ends; ///< of own rows begun, every 64 points

  std::vector<std::size_t> first_rows;     ///< by chunk, with an end
  std::vector<std::size_t> first_partials; ///< by chunk, with an end
  LatticeArray<std::int32_t> represents;   ///< vertex of each partial row

  std::vector<std::int32_t> shared;       ///< vertices with partial rows
  std::vector<std::uint32_t> shared_ends; ///< of their partial rows, after a 0
  std::vector<std::int32_t> shared_rows;  ///< those

  std::vector<LatticeGroup> groups;
  LatticeArray<float> self_responses; ///< by column

  std::size_t
  chunks() const
  {
    return first_rows.size() - 1;
  }

  /** \brief Bytes of all this. */
  std::size_t memory() const;
};

/** \brief Builds the lattice around the columns of features.
 * \param[in] order to take the points in; null = one that suits the features
 * \throws InvalidParameterException if a feature is not finite, there are none or more
 * than 16 a point, or they span too many deviations for the keys of the vertices */
LatticeStructure buildLattice(const LatticeFeatures& features,
                              const LatticeOrder& order, SimdTier tier);

} // namespace pcl_semantic
