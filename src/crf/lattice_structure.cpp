// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_structure.h"

#include "lattice_numbering.h"
#include "lattice_order.h"

#include <pcl_semantic/core/exceptions.h>

#include <limits>

namespace pcl_semantic {

namespace {

// So many that what points share is found in a chunk, so few that threads find work.
std::size_t
chunkPoints(std::size_t points)
{
  const std::size_t share = (points / 64 + 63) / 64 * 64;
  return std::min<std::size_t>(4096, std::max<std::size_t>(256, share));
}

template <typename Key>
void
build(const LatticeFeatures& features, const kernels::LatticeFrame& frame,
      const LatticeKeyBits& bits, SimdTier tier, LatticeStructure& structure)
{
  const LatticeVertices<Key> vertices =
      numberVertices<Key>(features, frame, bits, tier, structure);
  findRuns(vertices, tier, structure);
  findSelfResponses(vertices, tier, structure);
}

} // namespace

LatticeStructure
buildLattice(const LatticeFeatures& features, const LatticeOrder& order, SimdTier tier)
{
  double extents[kernels::most_dimensions] = {};
  const kernels::LatticeFrame frame = frameOf(features, extents);
  LatticeStructure structure;
  structure.frame = frame;
  structure.points = std::size_t(features.cols());
  structure.corners = std::size_t(features.rows()) + 1;
  structure.chunk_points = chunkPoints(structure.points);
  if (structure.points >
      std::size_t(std::numeric_limits<std::int32_t>::max()) / structure.corners)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        structure.points << " points with " << features.rows()
                                         << " features are too many for a lattice");
  const LatticeKeyBits bits(frame, extents);
  if (bits.bits > 128)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "features span too many deviations in "
                            << features.rows() << " dimensions: keys of lattice "
                            << "vertices would take " << bits.bits
                            << " bits, expected at most 128");
  structure.columns = order ? order
                            : std::make_shared<const LatticeArray<std::int32_t>>(
                                  orderInTiles(features, frame, extents));
  if (bits.bits <= 64)
    build<std::uint64_t>(features, frame, bits, tier, structure);
  else
    build<LongLatticeKey>(features, frame, bits, tier, structure);
  return structure;
}

std::size_t
LatticeStructure::memory() const
{
  std::size_t bytes = columns->bytes() + corner_rows.bytes() + weights.bytes() +
                      represents.bytes() + self_responses.bytes() +
                      row_ends.size() * sizeof(std::int32_t) +
                      shared.size() * 2 * sizeof(std::int32_t) +
                      shared_rows.size() * sizeof(std::int32_t);
  for (const LatticeGroup& group : groups)
    for (const LatticeBucket& bucket : group.buckets)
      bytes +=
          (bucket.steps.capacity() + 2 * bucket.begins.size()) * sizeof(std::int32_t);
  return bytes;
}

} // namespace pcl_semantic
