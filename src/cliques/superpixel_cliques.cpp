// SPDX-License-Identifier: BSD-3-Clause
#include "organized_image.h"
#include "voxel_votes.h"

#include <pcl_semantic/cliques/superpixel_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/voxel_table.h>

#include <pcl/common/point_tests.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr int kNone = -1;

// Numbers without gaps, in the order of the first points that have them.
int
renumber(std::vector<int>& parts)
{
  int largest = kNone, count = 0;
  for (const int part : parts)
    largest = std::max(largest, part);
  std::vector<int> numbers(std::size_t(largest + 1), kNone);
  for (int& part : parts) {
    if (part == kNone)
      continue;
    int& number = numbers[std::size_t(part)];
    if (number == kNone)
      number = count++;
    part = number;
  }
  return count;
}

} // namespace

void
SuperpixelParameters::validate() const
{
  slic.validate();
  DepthJumps{passing_distance, 0.0}.validate();
  if (min_voxels < 1)
    PCL_THROW_EXCEPTION(InvalidParameterException, "superpixels: min_voxels is "
                                                       << min_voxels
                                                       << ", expected 1 or more");
}

SuperpixelCliques::SuperpixelCliques(const SuperpixelParameters& parameters)
    : parameters_(parameters)
{
  parameters_.validate();
}

void
SuperpixelCliques::setFrame(const Cloud::ConstPtr& cloud,
                            const Eigen::Isometry3d& T_world_camera)
{
  if (!T_world_camera.matrix().allFinite())
    PCL_THROW_EXCEPTION(BadInputException,
                        "superpixels: the pose of the frame is not finite");
  if (cloud && !cloud->empty() && !cloud->isOrganized())
    PCL_THROW_EXCEPTION(BadInputException,
                        "superpixels need an organized cloud, an image of points; this "
                        "one is a list of "
                            << cloud->size());
  frame_ = cloud;
  T_world_camera_ = T_world_camera;
}

void
SuperpixelCliques::setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size)
{
  if (!(voxel_size > 0.0 && std::isfinite(voxel_size)))
    PCL_THROW_EXCEPTION(InvalidParameterException, "superpixels: voxel size is "
                                                       << voxel_size
                                                       << " m, expected more than 0");
  voxels_ = indices;
  voxel_size_ = voxel_size;
}

void
SuperpixelCliques::clear()
{
  kept_voxels_.clear();
  kept_parts_.clear();
}

std::vector<pcl::PointIndices>
SuperpixelCliques::generate(const Cloud& cloud)
{
  if (cloud.size() != voxels_.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "superpixels: " << voxels_.size() << " voxels for a cloud of "
                                        << cloud.size() << " points");
  std::vector<int> parts = partsOfVoxels();
  if (parameters_.keep)
    keepParts(parts);
  std::vector<pcl::PointIndices> cliques(std::size_t(renumber(parts)));
  if (parameters_.keep) {
    kept_voxels_ = voxels_;
    kept_parts_ = parts;
  }
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (parts[i] != kNone && pcl::isXYZFinite(cloud[i]))
      cliques[std::size_t(parts[i])].indices.push_back(pcl::index_t(i));
  const auto is_small = [&](const pcl::PointIndices& clique) {
    return clique.indices.size() < std::size_t(parameters_.min_voxels);
  };
  cliques.erase(std::remove_if(cliques.begin(), cliques.end(), is_small),
                cliques.end());
  return cliques;
}

// What the frame says of each point.
std::vector<int>
SuperpixelCliques::partsOfVoxels() const
{
  if (!frame_ || frame_->empty() || voxels_.empty())
    return std::vector<int>(voxels_.size(), kNone);
  const cv::Mat segments = slicSuperpixels(imageOf(*frame_), parameters_.slic);
  const SurfaceParts parts = splitAtDepthJumps(
      segments, *frame_, {parameters_.passing_distance, 2.0 * voxel_size_});
  return pcl_semantic::partsOfVoxels(*frame_, parts, T_world_camera_, voxels_,
                                     voxel_size_);
}

// Gives points that the frame does not see what they had the last time.
void
SuperpixelCliques::keepParts(std::vector<int>& parts)
{
  const int first =
      parts.empty() ? 0 : 1 + *std::max_element(parts.begin(), parts.end());
  const VoxelTable table(kept_voxels_);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] != kNone)
      continue;
    const std::int32_t kept = table.find(voxels_[i]);
    if (kept != VoxelTable::kNone && kept_parts_[std::size_t(kept)] != kNone)
      parts[i] = first + kept_parts_[std::size_t(kept)];
  }
}

} // namespace pcl_semantic
