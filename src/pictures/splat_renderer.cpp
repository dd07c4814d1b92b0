// SPDX-License-Identifier: BSD-3-Clause
#include "splat_renderer.h"

#include "core/fail.h"
#include "core/label_number.h"
#include "core/parallel_guard.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <omp.h>

namespace pcl_semantic {

namespace {

// Measured, see doc/map.md.
constexpr float kRadius = 0.87f; ///< of a splat [voxels]: half the diagonal of a cube
constexpr float kBehindFirst = 1.0f;   ///< depth in which classes vote [m]
constexpr float kFirstOpacity = 0.05f; ///< of the first splat of a ray
constexpr float kLeastOpacity = 1e-5f; ///< fainter ones are ignored
constexpr double kNearPlane = 0.1;     ///< [m]
constexpr int kTile = 32;              ///< edge of the pixels that are a thread's task

/** \brief A voxel in the camera frame. */
struct Splat {
  Eigen::Vector3f point; ///< [m]
  float opacity = 0.0f;  ///< in the middle
  std::uint32_t voxel = 0;
  Label label = 0;
  int first_row = 0, last_row = -1, first_column = 0, last_column = -1;
};

/** \brief The pixels that a splat may cover, borders included. */
void
setFootprint(const StereoCamera& camera, const Eigen::Vector3d& point, double radius,
             Splat& splat)
{
  // The silhouette of a sphere lies within the projection of its bounding box.
  const double near = point.z() - radius, far = point.z() + radius;
  const auto least = [&](double centre, double focal, double principal) {
    const double at = centre - radius;
    return focal * at / (at > 0.0 ? far : near) + principal;
  };
  const auto most = [&](double centre, double focal, double principal) {
    const double at = centre + radius;
    return focal * at / (at > 0.0 ? near : far) + principal;
  };
  // Clamped first, because a pixel far outside may not fit an int.
  const auto first = [](double pixel, int size) {
    return int(std::ceil(std::clamp(pixel, 0.0, double(size))));
  };
  const auto last = [](double pixel, int size) {
    return int(std::floor(std::clamp(pixel, -1.0, double(size - 1))));
  };
  splat.first_column = first(least(point.x(), camera.fx, camera.cx), camera.width);
  splat.last_column = last(most(point.x(), camera.fx, camera.cx), camera.width);
  splat.first_row = first(least(point.y(), camera.fy, camera.cy), camera.height);
  splat.last_row = last(most(point.y(), camera.fy, camera.cy), camera.height);
}

/** \brief The splats in view, the nearest first. */
std::vector<Splat>
splatsOf(const VoxelCloud& voxels, const StereoCamera& camera,
         const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  const double radius = double(kRadius) * voxels.voxel_size;
  const Eigen::Matrix3d rotation = T_world_camera.linear().transpose();
  const Eigen::Vector3d shift = voxels.origin - T_world_camera.translation();
  std::vector<Splat> splats;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const pcl::PointXYZRGBL& voxel = (*voxels.cloud)[i];
    const Label label = requireLabel(voxel.label);
    const Eigen::Vector3d point =
        rotation * (voxel.getVector3fMap().cast<double>() + shift);
    if (!(point.z() - radius >= kNearPlane && point.z() <= max_depth))
      continue;
    Splat splat;
    setFootprint(camera, point, radius, splat);
    if (splat.first_row > splat.last_row || splat.first_column > splat.last_column)
      continue;
    const float scans =
        voxels.observations.empty() ? 1.0f : float(voxels.observations[i]);
    splat.point = point.cast<float>();
    splat.opacity = scans * scans / (scans * scans + 2.0f);
    splat.voxel = std::uint32_t(i);
    splat.label = label;
    splats.push_back(splat);
  }
  std::sort(splats.begin(), splats.end(), [&](const Splat& a, const Splat& b) {
    return a.point.z() != b.point.z()
               ? a.point.z() < b.point.z()
               : VoxelIndexLess()(voxels.indices[a.voxel], voxels.indices[b.voxel]);
  });
  return splats;
}

/** \brief A square of pixels, and the weights of the classes in each. */
class Tile {
public:
  Tile(const StereoCamera& camera, double voxel_size, int classes)
      : camera_(camera),
        squared_radius_(float(std::pow(double(kRadius) * voxel_size, 2.0))),
        classes_(classes), rays_(kTile * kTile), light_(rays_.size()),
        first_(rays_.size()), votes_(rays_.size() * std::size_t(classes))
  {}

  void
  begin(int row, int column)
  {
    row_ = row;
    column_ = column;
    end_row_ = std::min(row + kTile, camera_.height);
    end_column_ = std::min(column + kTile, camera_.width);
    for (int v = row_; v < end_row_; ++v)
      for (int u = column_; u < end_column_; ++u)
        rays_[pixelOf(v, u)] = camera_.unproject(u, v, 1.0).normalized().cast<float>();
    std::fill(light_.begin(), light_.end(), 1.0f);
    std::fill(first_.begin(), first_.end(), std::numeric_limits<float>::infinity());
    std::fill(votes_.begin(), votes_.end(), Vote());
  }

  void
  draw(const Splat& splat)
  {
    const int last_row = std::min(splat.last_row, end_row_ - 1);
    const int last_column = std::min(splat.last_column, end_column_ - 1);
    for (int v = std::max(splat.first_row, row_); v <= last_row; ++v)
      for (int u = std::max(splat.first_column, column_); u <= last_column; ++u) {
        const std::size_t pixel = pixelOf(v, u);
        if (splat.point.z() > first_[pixel] + kBehindFirst)
          continue;
        const float inside =
            1.0f - splat.point.cross(rays_[pixel]).squaredNorm() / squared_radius_;
        if (!(inside > 0.0f))
          continue;
        const float squared = inside * inside;
        const float opacity = splat.opacity * squared * squared * inside;
        if (!(opacity > kLeastOpacity))
          continue;
        if (opacity > kFirstOpacity)
          first_[pixel] = std::min(first_[pixel], splat.point.z());
        const float weight = light_[pixel] * opacity;
        light_[pixel] -= weight;
        votes_[pixel * std::size_t(classes_) + splat.label].add(weight, splat);
      }
  }

  void
  copyTo(SplatImage& image) const
  {
    for (int v = row_; v < end_row_; ++v)
      for (int u = column_; u < end_column_; ++u) {
        const std::size_t pixel = pixelOf(v, u);
        if (light_[pixel] == 1.0f)
          continue;
        const Vote* const votes = &votes_[pixel * std::size_t(classes_)];
        const Vote* winner = votes; // unlabelled, unless a class has a weight
        for (int l = 1; l < classes_; ++l)
          if (votes[l].sum > (winner == votes ? 0.0f : winner->sum))
            winner = votes + l;
        image.label.at<Label>(v, u) = Label(winner - votes);
        image.voxel.at<std::int32_t>(v, u) = std::int32_t(winner->voxel);
        image.depth.at<float>(v, u) = winner->depth;
      }
  }

private:
  /** \brief The weight of a class, and its voxel with the largest one. */
  struct Vote {
    float sum = 0.0f, most = 0.0f, depth = 0.0f;
    std::uint32_t voxel = 0;

    void
    add(float weight, const Splat& splat)
    {
      sum += weight;
      if (weight > most) {
        most = weight;
        depth = splat.point.z();
        voxel = splat.voxel;
      }
    }
  };

  std::size_t
  pixelOf(int v, int u) const
  {
    return std::size_t(v - row_) * kTile + std::size_t(u - column_);
  }

  const StereoCamera& camera_;
  float squared_radius_; // [m^2]
  int classes_;          // with the unlabelled one
  int row_ = 0, column_ = 0, end_row_ = 0, end_column_ = 0;
  std::vector<Eigen::Vector3f> rays_; // unit length
  std::vector<float> light_;          // that passes all splats so far
  std::vector<float> first_;          // depth of the first splat [m]
  std::vector<Vote> votes_;           // by pixel, then by class
};

} // namespace

SplatImage
renderSplats(const VoxelCloud& voxels, const StereoCamera& camera,
             const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  if (!(voxels.size() == 0 || voxels.voxel_size > 0.0))
    badParameter("voxel size is ", voxels.voxel_size, " m, expected more than 0");
  if (voxels.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
    badParameter(voxels.size(), " voxels, expected fewer than 2^31");
  camera.validate();
  if (camera.width <= 0 || camera.height <= 0)
    badParameter("the camera has no image size");
  if (!(max_depth > 0.0))
    badParameter("largest depth is ", max_depth, " m, expected more than 0");
  const std::vector<Splat> splats = splatsOf(voxels, camera, T_world_camera, max_depth);
  const int across = (camera.width + kTile - 1) / kTile;
  const int down = (camera.height + kTile - 1) / kTile;
  std::vector<std::vector<std::uint32_t>> tiles(std::size_t(across) *
                                                std::size_t(down));
  int classes = 1;
  for (std::size_t s = 0; s < splats.size(); ++s) {
    const Splat& splat = splats[s];
    classes = std::max(classes, splat.label + 1);
    for (int y = splat.first_row / kTile; y <= splat.last_row / kTile; ++y)
      for (int x = splat.first_column / kTile; x <= splat.last_column / kTile; ++x)
        tiles[std::size_t(y * across + x)].push_back(std::uint32_t(s));
  }
  SplatImage image{cv::Mat::zeros(camera.height, camera.width, CV_8UC1),
                   cv::Mat(camera.height, camera.width, CV_32SC1, cv::Scalar(-1)),
                   cv::Mat::zeros(camera.height, camera.width, CV_32FC1)};
  std::vector<Tile> buffers(std::size_t(omp_get_max_threads()),
                            Tile(camera, voxels.voxel_size, classes));
  ParallelGuard guard;
  // One thread per tile, so the result does not depend on the number of threads.
#pragma omp parallel for schedule(dynamic)
  for (std::size_t t = 0; t < tiles.size(); ++t)
    guard.run([&] {
      Tile& tile = buffers[std::size_t(omp_get_thread_num())];
      tile.begin(int(t) / across * kTile, int(t) % across * kTile);
      for (const std::uint32_t s : tiles[t])
        tile.draw(splats[s]);
      tile.copyTo(image);
    });
  guard.rethrow();
  return image;
}

} // namespace pcl_semantic
