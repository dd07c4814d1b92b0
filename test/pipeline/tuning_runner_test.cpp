// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"
#include "support/tuning_street.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/depth_lookup.h>
#include <pcl_semantic/evaluation/label_reprojection.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/pipeline/tuning_runner.h>

#include <gtest/gtest.h>

#include <thread>

namespace pcl_semantic {

namespace {

cv::Mat
networkLabels(const MappedFrame& mapped)
{
  cv::Mat labels(mapped.frame.left.size(), CV_8UC1);
  for (Eigen::Index i = 0; i < mapped.network.size(); ++i)
    labels.data[i] = mapped.network.mapLabel(i);
  return labels;
}

// The plain way: whole images of a mapper that is left alone.
TuningResult
mappedAndCompared(const TuningSequence& street, const LabelSet& label_set,
                  MapperConfig config)
{
  TuningResult result(label_set.size());
  const std::string crf = config.crf;
  for (const bool is_refined : {false, true}) {
    config.crf = is_refined ? crf : "none";
    SemanticMapper mapper(street.camera(), label_set, config,
                          street.makePredictor(config.label_confidence),
                          street.makePoses());
    for (std::size_t i = 0; i < street.frames().size(); ++i) {
      const MappedFrame mapped = mapper.process(street.frames()[i]);
      const cv::Mat& truth = street.truth(i);
      if (truth.empty())
        continue;
      const double depth = config.map.max_range;
      const cv::Mat at_depth =
          labelsAtDepth(mapper.map(), *mapped.cloud, mapped.T_world_camera, depth);
      const cv::Mat rendered =
          renderLabels(mapped.voxels, street.camera(), mapped.T_world_camera, depth)
              .labels;
      for (const auto& [counts, labels] :
           {std::pair(&result.at_depth, at_depth), {&result.rendered, rendered}}) {
        (is_refined ? counts->refined : counts->fused).add(truth, labels);
        if (is_refined)
          counts->network.add(truth, networkLabels(mapped), labels);
      }
    }
  }
  return result;
}

// Without the pixels that have no truth.
void
expectSame(const ConfusionMatrix& fast, const ConfusionMatrix& plain)
{
  std::uint64_t pixels = 0;
  for (int truth = 1; truth <= plain.classes(); ++truth)
    for (int label = 0; label <= plain.classes(); ++label) {
      EXPECT_EQ(fast(Label(truth), Label(label)), plain(Label(truth), Label(label)));
      pixels += plain(Label(truth), Label(label));
    }
  EXPECT_GT(pixels, 1000u);
}

void
expectSame(const TuningResult& fast, const TuningResult& plain)
{
  for (const auto view : {&TuningResult::at_depth, &TuningResult::rendered})
    for (const auto counts :
         {&TuningCounts::network, &TuningCounts::fused, &TuningCounts::refined})
      expectSame((fast.*view).*counts, (plain.*view).*counts);
}

TEST_F(TuningStreet, SharedMapsCountAsMapsOfTheirOwn)
{
  const auto street = open();
  TuningRunner runner({street}, labelSet(), 1000000000);
  std::vector<MapperConfig> configs(7, coarse());
  configs[1].crf_parameters.appearance_weight = 30.0;
  configs[2].crf = "hierarchical";
  configs[3].crf = "none";
  configs[4].map.fusion.miss_probability = 0.3;
  configs[5].crf_every = 2; // does not refine every frame afresh
  configs[6].max_deviation = 0.7;
  for (const MapperConfig& config : configs)
    expectSame(runner.run(config, 0), mappedAndCompared(*street, labelSet(), config));
  // Again, from what is known.
  expectSame(runner.run(configs[1], 0),
             mappedAndCompared(*street, labelSet(), configs[1]));
}

// Its fused labels are those of a map that earlier CRFs have changed.
TEST_F(TuningStreet, WhatIsWrittenBackIsMappedFromTheStart)
{
  const auto street = open();
  MapperConfig config = coarse();
  TuningRunner runner({street}, labelSet(), 1000000000);
  const TuningResult apart = runner.run(config, 0);
  config.crf_write_back = true;
  const TuningResult fast = runner.run(config, 0);
  const TuningResult plain = mappedAndCompared(*street, labelSet(), config);
  expectSame(fast.at_depth.refined, plain.at_depth.refined);
  expectSame(fast.rendered.refined, plain.rendered.refined);
  int differing = 0;
  for (int label = 1; label <= labelSet().size(); ++label)
    differing += fast.at_depth.refined(3, Label(label)) !=
                 apart.at_depth.refined(3, Label(label));
  EXPECT_GT(differing, 0);
}

TEST_F(TuningStreet, WithoutMemoryAndWithThreadsNothingChanges)
{
  const auto street = open();
  TuningRunner keeps({street, street}, labelSet(), 1000000000);
  TuningRunner forgets({street, street}, labelSet(), 0);
  const TuningResult expected = keeps.run(coarse(), 0);
  std::vector<TuningResult> results(4, TuningResult(labelSet().size()));
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < results.size(); ++i)
    threads.emplace_back(
        [&, i] { results[i] = (i < 2 ? keeps : forgets).run(coarse(), i % 2); });
  for (std::thread& thread : threads)
    thread.join();
  for (const TuningResult& result : results)
    expectSame(result, expected);
}

TEST_F(TuningStreet, MapsDependOnEverythingBeforeTheCrf)
{
  const std::string key = TuningRunner::mapKey(MapperConfig());
  for (const char* const before :
       {"stereo", "disparities", "max_deviation", "label_confidence", "voxel_size",
        "window", "hit_probability", "pixel_fusion", "crf_every"})
    EXPECT_NE(key.find(std::string(before) + " "), std::string::npos) << before;
  for (const char* const after : {"smoothness_weight", "colour_deviation",
                                  "clique_weight", "clique_truncation", "threads"})
    EXPECT_EQ(key.find(std::string(after) + " "), std::string::npos) << after;
}

TEST_F(TuningStreet, TheDescriptionKnowsTheData)
{
  const std::string before = open()->describe();
  EXPECT_EQ(open()->describe(), before);
  EXPECT_NE(before.find("3 frames, 2 with truth"), std::string::npos) << before;
  const std::string path = folder_->path("street/gt/000002.png");
  const std::string bytes = bytesOf(path);
  std::filesystem::copy_file(folder_->path("street/gt/000000.png"), path,
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(open()->describe(), before);
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_EQ(open()->describe(), before);
}

TEST_F(TuningStreet, WhatIsMissingIsNamed)
{
  const auto messageOf = [](const TuningFolders& folders) {
    return thrownMessage<BadInputException>(
        [&] { TuningSequence(folders, labelSet().size()); });
  };
  const TemporaryFolder empty;
  const std::string street = folder_->path("street");
  EXPECT_TRUE(holds(messageOf({street, street + "/labels", empty.path()}),
                    "has no truth image of a frame of " + street));
  EXPECT_TRUE(holds(messageOf({street, empty.path(), street + "/gt"}), "no labels"));
  EXPECT_TRUE(holds(messageOf({empty.path(), street + "/labels", street + "/gt"}),
                    empty.path()));
  writePng(empty.path("000000.png"), cv::Mat(64, 100, CV_8UC1, cv::Scalar::all(1)));
  EXPECT_TRUE(
      holds(messageOf({street, street + "/labels", empty.path()}),
            "000000.png: 100 x 64 pixels with labels up to 1, expected 208 x 64"));
  writePng(empty.path("000000.png"), cv::Mat(64, 208, CV_8UC1, cv::Scalar::all(12)));
  EXPECT_TRUE(
      holds(messageOf({street, street + "/labels", empty.path()}), "labels up to 12"));
}

} // namespace

} // namespace pcl_semantic
