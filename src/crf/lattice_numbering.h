// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lattice_keys.h"
#include "lattice_structure.h"

namespace pcl_semantic {

/** \brief The vertices of a lattice. */
template <typename Key> struct LatticeVertices {
  LatticeKeys<Key> arithmetic;
  LatticeArray<Key> keys; ///< by number

  /** \brief From each corner of a simplex to the next: (d + 1) x 64 for every 64 sorted
   * points. */
  LatticeArray<std::uint8_t> directions;
};

/** \brief Finds the simplices of the sorted points and numbers their vertices: fills in
 * everything of a structure with columns, corners and chunk_points but its groups and
 * self-responses. */
template <typename Key>
LatticeVertices<Key>
numberVertices(const LatticeFeatures& features, const kernels::LatticeFrame& frame,
               const LatticeKeyBits& bits, SimdTier tier, LatticeStructure& structure);

extern template LatticeVertices<std::uint64_t>
numberVertices(const LatticeFeatures&, const kernels::LatticeFrame&,
               const LatticeKeyBits&, SimdTier, LatticeStructure&);
extern template LatticeVertices<LongLatticeKey>
numberVertices(const LatticeFeatures&, const kernels::LatticeFrame&,
               const LatticeKeyBits&, SimdTier, LatticeStructure&);

/** \brief Finds the runs of vertices in every direction: the groups of a structure. */
template <typename Key>
void findRuns(const LatticeVertices<Key>& vertices, SimdTier tier,
              LatticeStructure& structure);

extern template void findRuns(const LatticeVertices<std::uint64_t>&, SimdTier,
                              LatticeStructure&);
extern template void findRuns(const LatticeVertices<LongLatticeKey>&, SimdTier,
                              LatticeStructure&);

/** \brief What a one at each point sends back to it: the self-responses of a structure
 * that is complete but for them. */
template <typename Key>
void findSelfResponses(const LatticeVertices<Key>& vertices, SimdTier tier,
                       LatticeStructure& structure);

extern template void findSelfResponses(const LatticeVertices<std::uint64_t>&, SimdTier,
                                       LatticeStructure&);
extern template void findSelfResponses(const LatticeVertices<LongLatticeKey>&, SimdTier,
                                       LatticeStructure&);

} // namespace pcl_semantic
