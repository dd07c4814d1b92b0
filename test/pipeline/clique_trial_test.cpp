// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/map_cliques.h"
#include "support/temporary_folder.h"
#include "synthesize/labels.h"
#include "synthesize/writer.h"

#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

// A small sequence with ground truth for all frames except the second.
class CalibrationStreet : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    folder_ = std::make_unique<TemporaryFolder>();
    const SyntheticScene scene(5, frames);
    const SyntheticRenderer renderer(scene, 208, 64);
    const SyntheticWriter writer(folder_->path("street"));
    writer.writeSequence(scene, renderer.camera());
    for (int i = 0; i < frames; ++i) {
      const SyntheticView view = renderer.render(i);
      writer.writeFrame(view, syntheticDistributions(view, 5));
    }
    std::filesystem::remove(folder_->path("street/gt/000001.png"));
  }

  static LabelSet
  labelSet()
  {
    return readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
  }

  static std::shared_ptr<const CalibrationSequence>
  open()
  {
    return std::make_shared<CalibrationSequence>(
        CalibrationFolders{folder_->path("street"), folder_->path("street/labels"),
                           folder_->path("street/gt")},
        labelSet().size());
  }

  static MapperConfig
  coarse()
  {
    MapperConfig config;
    config.map.voxel_size = 0.2;
    return config;
  }

  static constexpr int frames = 3;
  static inline std::unique_ptr<TemporaryFolder> folder_;
};

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
