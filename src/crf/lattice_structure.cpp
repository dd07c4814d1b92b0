// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_structure.h"
#include "core/fail.h"
#include "lattice_keys.h"
#include "lattice_runs.h"
#include "lattice_vertices.h"
#include "self_responses.h"
#include "sorted_buckets.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

using Features = Eigen::Ref<const Eigen::MatrixXf>;

constexpr std::size_t part_size = SortedBuckets::part_size;
constexpr std::size_t tile_points = 2048;

/** \brief The least features and the extents from there to the largest.
 * \throws InvalidParameterException as buildLattice() */
kernels::LatticeFrame
frameOf(const Features& features, double* extents)
{
  const auto d = std::size_t(features.rows());
  if (d < 1 || d > std::size_t(kernels::max_dimensions))
    badParameter("points have ", d, " features, expected 1 to ",
                 kernels::max_dimensions);
  const auto count = std::size_t(features.cols()),
             parts = SortedBuckets::partsOf(count);
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
  return std::move(SortedBuckets(tile_of, std::size_t(across * down)).members);
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
build(const Features& features, const LatticeKeyBits& bits, SimdTier tier,
      LatticeStructure& structure)
{
  const LatticeVertices<Key> vertices =
      findVertices<Key>(features, bits, tier, structure);
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
    build<std::uint64_t>(features, bits, tier, structure);
  else
    build<LongLatticeKey>(features, bits, tier, structure);
  return structure;
}

} // namespace pcl_semantic