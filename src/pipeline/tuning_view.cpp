/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/evaluation/label_reprojection.h>
#include <pcl_semantic/pipeline/tuning_view.h>

#include <unordered_map>

namespace pcl_semantic {

namespace {

std::vector<std::size_t>
pixelsOf(const cv::Mat& truth)
{
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < truth.total(); ++i)
    if (truth.data[i] != kUnlabelled)
      pixels.push_back(i);
  return pixels;
}

// As labelsAtDepth() finds them.
std::vector<std::int32_t>
voxelsAtDepth(const MappedFrame& mapped, const SemanticVoxelMap& map,
              const std::vector<std::size_t>& pixels, double max_depth)
{
  std::unordered_map<VoxelIndex, std::int32_t, VoxelIndexHash> places;
  places.reserve(mapped.voxels.size());
  for (std::size_t i = 0; i < mapped.voxels.size(); ++i)
    places.emplace(mapped.voxels.indices[i], std::int32_t(i));
  std::vector<std::int32_t> voxels;
  for (const std::size_t pixel : pixels) {
    const pcl::PointXYZRGB& point = (*mapped.cloud)[pixel];
    voxels.push_back(-1);
    if (!(point.z <= max_depth)) // NaN too
      continue;
    const auto found = places.find(
        map.voxelOf(mapped.T_world_camera * point.getVector3fMap().cast<double>()));
    if (found != places.end())
      voxels.back() = found->second;
  }
  return voxels;
}

void
countPixels(const TuningView& view, const std::vector<std::int32_t>& seen,
            const std::vector<Label>& fused, TuningCounts& counts)
{
  const auto& cloud = *view.mapped.voxels.cloud;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto voxel = std::size_t(seen[i]);
    const bool is_seen = seen[i] >= 0;
    const Label refined = is_seen ? Label(cloud[voxel].label) : kUnlabelled;
    counts.refined.add(view.truth[i], refined, 1);
    counts.fused.add(view.truth[i], is_seen ? fused[voxel] : kUnlabelled, 1);
    if (refined != kUnlabelled)
      counts.network.add(view.truth[i], view.network[i], 1);
  }
}

} // namespace

std::size_t
TuningView::memory() const
{
  const VoxelCloud& voxels = mapped.voxels;
  return voxels.size() * (sizeof(pcl::PointXYZRGBL) + sizeof(VoxelIndex)) +
         sizeof(float) * std::size_t(voxels.measured.matrix().size() +
                                     voxels.refined.matrix().size()) +
         mapped.cloud->size() * sizeof(pcl::PointXYZRGB) +
         mapped.frame.left.total() * mapped.frame.left.elemSize();
}

TuningView
makeTuningView(MappedFrame mapped, const SemanticVoxelMap& map,
               const StereoCamera& camera, const cv::Mat& truth, double max_depth)
{
  TuningView view;
  const std::vector<std::size_t> pixels = pixelsOf(truth);
  if (!pixels.empty()) {
    const cv::Mat seen =
        renderLabels(mapped.voxels, camera, mapped.T_world_camera, max_depth).voxels;
    for (const std::size_t pixel : pixels) {
      view.truth.push_back(truth.data[pixel]);
      view.network.push_back(mapped.network.mapLabel(Eigen::Index(pixel)));
      view.rendered.push_back(seen.ptr<std::int32_t>()[pixel]);
    }
    view.at_depth = voxelsAtDepth(mapped, map, pixels, max_depth);
  }
  mapped.network = LabelDistributions();
  mapped.disparity = DisparityImage();
  mapped.frame.right = cv::Mat();
  mapped.voxels.observations = {};
  view.mapped = std::move(mapped);
  return view;
}

void
countView(const TuningView& view, TuningResult& result)
{
  if (view.truth.empty())
    return;
  const LabelDistributions& measured = view.mapped.voxels.measured;
  std::vector<Label> fused(std::size_t(measured.size()));
  for (Eigen::Index i = 0; i < measured.size(); ++i)
    fused[std::size_t(i)] = measured.mapLabel(i);
  countPixels(view, view.at_depth, fused, result.at_depth);
  countPixels(view, view.rendered, fused, result.rendered);
}

} // namespace pcl_semantic
