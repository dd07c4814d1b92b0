// SPDX-License-Identifier: BSD-3-Clause
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
  std::unordered_map<VoxelIndex, std::int32_t, VoxelIndexHash> places; // of those asked
  std::vector<const std::int32_t*> asked; // by each pixel; null = no depth
  for (const std::size_t pixel : pixels) {
    const pcl::PointXYZRGB& point = (*mapped.cloud)[pixel];
    asked.push_back(nullptr);
    if (point.z <= max_depth) // false for NaN
      asked.back() = &places
                          .emplace(map.voxelOf(mapped.T_world_camera *
                                               point.getVector3fMap().cast<double>()),
                                   -1)
                          .first->second; // stays where it is
  }
  for (std::size_t i = 0; i < mapped.voxels.size(); ++i) {
    const auto place = places.find(mapped.voxels.indices[i]);
    if (place != places.end())
      place->second = std::int32_t(i);
  }
  std::vector<std::int32_t> voxels;
  for (const std::int32_t* const place : asked)
    voxels.push_back(place ? *place : -1);
  return voxels;
}

void
countPixels(const TuningView& view, const std::vector<std::int32_t>& seen,
            TuningCounts& counts)
{
  const VoxelCloud& voxels = view.mapped.voxels;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    Label fused = kUnlabelled, refined = kUnlabelled;
    if (seen[i] >= 0) {
      fused = voxels.measured.mapLabel(seen[i]);
      refined = Label((*voxels.cloud)[std::size_t(seen[i])].label);
    }
    counts.fused.add(view.truth[i], fused, 1);
    counts.refined.add(view.truth[i], refined, 1);
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
        renderLabels(mapped.voxels, camera, mapped.T_world_camera, max_depth).places;
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
  countPixels(view, view.at_depth, result.at_depth);
  countPixels(view, view.rendered, result.rendered);
}

} // namespace pcl_semantic
