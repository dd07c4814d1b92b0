// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/lattice_filter.h"
#include "lattice_structure.h"

#include <pcl_semantic/crf/permutohedral_lattice.h>

#include <memory>
#include <mutex>

namespace pcl_semantic {

/** \brief Memory for the values on a lattice, kept from one product to the next: to get
 * it costs more than to fill it. Threads may use it at a time. */
class LatticeMemory {
public:
  using Values = std::shared_ptr<LatticeArray<float>>;

  Values borrow(std::size_t size);
  void giveBack(const Values& values);

private:
  std::mutex mutex_;
  std::vector<Values> spare_;
};

/** \brief The way of up to 16 rows of values over a lattice, in parts that threads
 * share: first every splat, then every merge, every copy, every blur of a stage after
 * those of the stage before, and every slice. */
class LatticePass {
public:
  LatticePass(const LatticeStructure& structure, const kernels::LatticeColumns& columns,
              LatticeBlur order, SimdTier tier, LatticeMemory& memory);
  ~LatticePass() { memory_.giveBack(values_); }
  LatticePass(const LatticePass&) = delete;
  LatticePass& operator=(const LatticePass&) = delete;

  /** \brief Floats of a row for a number of rows of interest. */
  static std::size_t
  widthFor(std::size_t rows)
  {
    return rows > 8 ? 16 : rows > 4 ? 8 : rows > 1 ? 4 : 1;
  }

  void
  splat(std::size_t chunk) const
  {
    loops_.splat(points(chunk), columns_, forward_);
  }

  std::size_t merges() const;
  void merge(std::size_t part) const;

  /** \brief Copies of the values to the half that is blurred in reverse. */
  std::size_t copies() const;
  void copy(std::size_t part) const;

  std::size_t
  stages() const
  {
    return structure_.groups.size();
  }

  std::size_t blurs(std::size_t stage) const;
  void blur(std::size_t stage, std::size_t part) const;

  void
  slice(std::size_t chunk) const
  {
    loops_.slice(points(chunk), columns_, forward_, half_);
  }

private:
  kernels::LatticePoints points(std::size_t chunk) const;

  const LatticeStructure& structure_;
  const kernels::LatticeColumns columns_;
  LatticeMemory& memory_;
  std::size_t width_;
  std::size_t half_;
  const kernels::LatticeFilter& loops_;
  LatticeMemory::Values values_;
  float* forward_; // blurred in the order of directions
  float* reverse_; // blurred in the reverse order; or null
};

} // namespace pcl_semantic
