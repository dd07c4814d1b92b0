// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/map_cliques.h"
#include "support/calibration_street.h"

#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

using CliqueTrialStreet = CalibrationStreet;

// Number of a clique's pixels of each class, the plain way: search by search.
std::map<std::pair<int, Label>, int>
countPixels(const MappedFrame& mapped, const SemanticVoxelMap& map,
            const StereoCamera& camera, const cv::Mat& truth, double max_depth,
            const std::vector<pcl::PointIndices>& cliques)
{
  const cv::Mat seen =
      renderLabels(mapped.voxels, camera, mapped.T_world_camera, max_depth).indices;
  const auto& indices = mapped.voxels.indices;
  std::map<std::pair<int, Label>, int> counts;
  const auto count = [&](std::ptrdiff_t place, Label label) {
    for (std::size_t c = 0; c < cliques.size(); ++c)
      for (const pcl::index_t member : cliques[c].indices)
        counts[{int(c), label}] += member == place;
  };
  for (std::size_t i = 0; i < truth.total(); ++i) {
    if (truth.data[i] == kUnlabelled)
      continue;
    count(seen.ptr<std::int32_t>()[i], truth.data[i]);
    const Eigen::Vector3d point = (*mapped.cloud)[i].getVector3fMap().cast<double>();
    if (!(point.z() <= max_depth))
      continue;
    const auto found = std::find(indices.begin(), indices.end(),
                                 map.voxelOf(mapped.T_world_camera * point));
    if (found != indices.end())
      count(found - indices.begin(), truth.data[i]);
  }
  return counts;
}

} // namespace

TEST_F(CliqueTrialStreet, ASampleForEachClassOfACliqueWithTheNumberOfItsPixels)
{
  const LabelSet label_set = labelSet();
  const std::vector<Label> ground{label_set.find("road"), label_set.find("sidewalk")};
  const auto street = open();
  MapperConfig config = coarse();
  config.crf = CRFModelType::unary;
  config.cliques = "cubes:2";
  config.map.max_range = 15.0; // some of the truth lies farther
  const CalibrationSamples samples = cliqueSamples(*street, config, label_set, ground);
  EXPECT_EQ(samples.of, "cliques");

  SemanticMapper mapper(label_set, config, street->makePoses(), street->camera(),
                        street->makePredictor(config.label_confidence));
  MapCliques map_cliques(config, label_set);
  map_cliques.setGround(ground);
  std::size_t s = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    const MappedFrame mapped = mapper.process(street->frames()[i]);
    map_cliques.setFrame(mapped.cloud, mapped.network, mapped.T_world_camera);
    const auto cliques = map_cliques.group(mapped.voxels);
    const CliqueEvidence evidence = map_cliques.evidence(mapped.voxels, cliques);
    for (const auto& [key, number] :
         countPixels(mapped, mapper.map(), street->camera(), street->truth(i),
                     config.map.max_range, cliques)) {
      if (number == 0)
        continue;
      ASSERT_LT(s, samples.truth.size());
      const auto clique = key.first;
      EXPECT_EQ(samples.truth[s], key.second);
      EXPECT_EQ(samples.weights[s], float(number));
      EXPECT_TRUE(samples.network.matrix().col(Eigen::Index(s)) ==
                  evidence.distributions.matrix().col(clique));
      EXPECT_EQ(samples.features[s][Feature::height],
                evidence.features[std::size_t(clique)][Feature::height]);
      ++s;
    }
  }
  EXPECT_EQ(s, samples.truth.size());
  EXPECT_GT(s, 50u);
}

} // namespace pcl_semantic
