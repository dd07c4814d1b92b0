// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "lattice_structure.h"
#include "lattice_vertices.h"

namespace pcl_semantic {

/** \brief Finds the runs of vertices in every direction: the groups of a structure. Key
 * is std::uint64_t or LongLatticeKey. */
template <typename Key>
void findRuns(const LatticeVertices<Key>& vertices, SimdTier tier,
              LatticeStructure& structure);

} // namespace pcl_semantic
