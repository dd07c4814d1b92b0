// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aligned_array.h"
#include "core/simd.h"
#include "lattice_keys.h"
#include "lattice_structure.h"

#include <Eigen/Core>

#include <cstdint>

namespace pcl_semantic {

/** \brief The vertices of a lattice. */
template <typename Key> struct LatticeVertices {
  LatticeKeys<Key> arithmetic;
  AlignedArray<Key> keys; ///< by number

  /** \brief From each corner of a simplex to the next: (d + 1) x 64 for every 64 sorted
   * points. */
  AlignedArray<std::uint8_t> directions;
};

/** \brief Finds the simplices of the sorted points and numbers their vertices: fills in
 * everything of a structure with frame, columns, corners and chunk_points but its
 * groups and self-responses. Key is std::uint64_t or LongLatticeKey. */
template <typename Key>
LatticeVertices<Key> findVertices(const Eigen::Ref<const Eigen::MatrixXf>& features,
                                  const LatticeKeyBits& bits, SimdTier tier,
                                  LatticeStructure& structure);

} // namespace pcl_semantic
