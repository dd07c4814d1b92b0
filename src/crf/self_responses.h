// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "lattice_structure.h"
#include "lattice_vertices.h"

namespace pcl_semantic {

/** \brief What a one at each point sends back to it: the self-responses of a structure
 * that is complete but for them. Key is std::uint64_t or LongLatticeKey. */
template <typename Key>
void findSelfResponses(const LatticeVertices<Key>& vertices, SimdTier tier,
                       LatticeStructure& structure);

} // namespace pcl_semantic
