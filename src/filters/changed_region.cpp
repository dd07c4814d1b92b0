// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/changed_region.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

// How near the blocks of a box are to changed ones: 0 = changed, 1 = beside one, 2, 3;
// 4 = farther.
class BlockLevels {
public:
  static constexpr std::uint8_t farthest = 4;

  BlockLevels(const Eigen::Matrix3Xf& positions, float edge)
      : low_(positions.rowwise().minCoeff()), edge_(edge)
  {
    const Eigen::Array3f extent = positions.rowwise().maxCoeff().array() - low_;
    // A block more at each side: points that are gone may lie outside.
    size_ = (extent / edge).min(1e6f).cast<std::int64_t>() + 3;
    // As many blocks as are cheaper to look at than to compute with their points.
    if (size_.prod() <= 64 * positions.cols() + (1 << 20))
      levels_.assign(std::size_t(size_.prod()), farthest);
  }

  bool
  fits() const
  {
    return !levels_.empty();
  }

  void
  markChanged(const Eigen::Vector3f& position)
  {
    const Eigen::Array3f place = ((position.array() - low_) / edge_).floor() + 1.0f;
    if ((place >= 0.0f).all() && (place < size_.cast<float>()).all())
      levels_[index(place)] = 0;
  }

  std::uint8_t
  level(const Eigen::Vector3f& position) const
  {
    return levels_[index(((position.array() - low_) / edge_).floor() + 1.0f)];
  }

  // Blocks beside a block of level k have level k + 1 at most.
  void
  spread()
  {
    const auto nx = std::size_t(size_.x()), ny = std::size_t(size_.y()),
               nz = std::size_t(size_.z());
    for (std::uint8_t level = 1; level < farthest; ++level) {
      spreadAlong(1, nx, level);
      spreadAlong(nx, ny, level);
      spreadAlong(nx * ny, nz, level);
    }
  }

private:
  std::size_t
  index(const Eigen::Array3f& place) const
  {
    const Eigen::Array<std::int64_t, 3, 1> block = place.cast<std::int64_t>();
    return std::size_t((block.z() * size_.y() + block.y()) * size_.x() + block.x());
  }

  // Marks blocks that are, or have beside them, one of at most a level.
  void
  spreadAlong(std::size_t stride, std::size_t size, std::uint8_t level)
  {
    const std::vector<std::uint8_t> before = levels_;
    std::size_t i = 0;
    while (i < before.size())
      for (std::size_t place = 0; place < size; ++place)
        for (const std::size_t end = i + stride; i < end; ++i) {
          const bool reached = before[i] <= level ||
                               (place > 0 && before[i - stride] <= level) ||
                               (place + 1 < size && before[i + stride] <= level);
          if (reached)
            levels_[i] = std::min(levels_[i], level);
        }
  }

  Eigen::Array3f low_;
  float edge_;
  Eigen::Array<std::int64_t, 3, 1> size_;
  std::vector<std::uint8_t> levels_;
};

} // namespace

ChangedRegion
findChangedRegion(const Eigen::Matrix3Xf& positions,
                  const std::vector<std::uint8_t>& changed,
                  const Eigen::Matrix3Xf& gone, float radius)
{
  ChangedRegion region;
  if (positions.cols() == 0)
    return region;
  BlockLevels blocks(positions, radius * 1.0001f);
  if (blocks.fits()) {
    for (Eigen::Index i = 0; i < positions.cols(); ++i)
      if (changed[std::size_t(i)])
        blocks.markChanged(positions.col(i));
    for (Eigen::Index i = 0; i < gone.cols(); ++i)
      blocks.markChanged(gone.col(i));
    blocks.spread();
  }
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    const std::uint8_t level = blocks.fits() ? blocks.level(positions.col(i)) : 0;
    if (level >= BlockLevels::farthest)
      continue;
    region.points.push_back(std::int32_t(i));
    region.fresh.push_back(level <= 1);
    region.result.push_back(level <= 2);
  }
  return region;
}

} // namespace pcl_semantic
