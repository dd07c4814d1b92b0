// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/label_reprojection.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/pipeline/clique_trial.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <map>

namespace pcl_semantic {

namespace {

constexpr int none = -1;

std::vector<int>
cliquesOfVoxels(const std::vector<pcl::PointIndices>& cliques, std::size_t voxels)
{
  std::vector<int> numbers(voxels, none);
  for (std::size_t c = 0; c < cliques.size(); ++c)
    for (const pcl::index_t i : cliques[c].indices)
      numbers[std::size_t(i)] = int(c);
  return numbers;
}

// The voxels that each pixel of truth meets, at its own depth and as the map is seen.
std::vector<std::pair<Label, std::int32_t>>
voxelsWithTruth(const MappedFrame& mapped, const StereoCamera& camera,
                const cv::Mat& truth, double max_depth)
{
  const VoxelLookup lookup(mapped.voxels);
  const RenderedLabels seen =
      renderLabels(mapped.voxels, camera, mapped.T_world_camera, max_depth);
  std::vector<std::pair<Label, std::int32_t>> voxels;
  const auto add = [&](Label label, std::int32_t place) {
    if (place != VoxelLookup::none)
      voxels.push_back({label, place});
  };
  for (std::size_t i = 0; i < mapped.cloud->size(); ++i) {
    const Label label = truth.data[i];
    if (label == kUnlabelled)
      continue;
    const pcl::PointXYZRGB& point = (*mapped.cloud)[i];
    if (point.z <= max_depth) // not if it is NaN
      add(label,
          lookup.at(mapped.T_world_camera * point.getVector3fMap().cast<double>()));
    add(label, seen.places.at<std::int32_t>(int(i)));
  }
  return voxels;
}

// A sample for each class that a clique's pixels have, with their number.
void
append(const CliqueEvidence& evidence,
       const std::vector<std::pair<Label, std::int32_t>>& truth,
       const std::vector<int>& cliques, CalibrationSamples& samples)
{
  std::map<std::pair<int, Label>, int> pixels;
  for (const auto& [label, voxel] : truth)
    if (cliques[std::size_t(voxel)] != none)
      ++pixels[{cliques[std::size_t(voxel)], label}];
  LabelDistributions::Matrix& all = samples.network.matrix();
  Eigen::Index column = all.cols();
  all.conservativeResize(evidence.distributions.classes(),
                         column + Eigen::Index(pixels.size()));
  for (const auto& [key, number] : pixels) {
    const auto& [clique, label] = key;
    all.col(column++) = evidence.distributions.matrix().col(clique);
    samples.features.push_back(evidence.features[std::size_t(clique)]);
    samples.truth.push_back(label);
    samples.weights.push_back(float(number));
  }
}

} // namespace

CalibrationSamples
cliqueSamples(const CalibrationSequence& sequence, const MapperConfig& config,
              const LabelSet& label_set, const std::vector<Label>& ground)
{
  MapperConfig plain = config;
  plain.crf = "none";
  SemanticMapper mapper(sequence.camera(), label_set, plain,
                        sequence.makePredictor(plain.label_confidence),
                        sequence.makePoses());
  if (!sequence.calibration().empty())
    mapper.setLabelCalibration(readCalibration(sequence.calibration(), label_set));
  MapCliques map_cliques(plain, label_set);
  map_cliques.setGround(ground);
  CalibrationSamples samples;
  samples.of = "cliques";
  for (std::size_t i = 0; i < sequence.frames().size(); ++i) {
    const MappedFrame mapped = mapper.process(sequence.frames()[i]);
    map_cliques.setFrame(mapped.cloud, mapped.network, mapped.T_world_camera);
    const auto cliques = map_cliques.group(mapped.voxels); // keeps superpixels, too
    if (!sequence.truth(i).empty())
      append(map_cliques.evidence(mapped.voxels, cliques),
             voxelsWithTruth(mapped, sequence.camera(), sequence.truth(i),
                             plain.map.max_range),
             cliquesOfVoxels(cliques, mapped.voxels.size()), samples);
  }
  return samples;
}

} // namespace pcl_semantic
