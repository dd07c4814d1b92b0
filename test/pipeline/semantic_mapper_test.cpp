// SPDX-License-Identifier: BSD-3-Clause
#include "support/known_frames.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"
#include "synthesize/labels.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/io/voxel_scene.h>
#include <pcl_semantic/map/seen_through.h>
#include <pcl_semantic/pipeline/late_labels.h>
#include <pcl_semantic/pipeline/mapping_output.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <gtest/gtest.h>

#include <array>
#include <future>
#include <map>

namespace {

using namespace pcl_semantic;

namespace fs = std::filesystem;

constexpr int frames = 5;

LabelSet
kitti11()
{
  return readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
}

class Street : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    renderer_ =
        std::make_unique<SyntheticRenderer>(SyntheticScene(3, frames), 416, 128);
    for (int i = 0; i < frames; ++i)
      views_.push_back(renderer_->render(i));
  }

  static void
  TearDownTestSuite()
  {
    renderer_.reset();
    views_.clear();
  }

  // The ground truth poses of the street.
  static std::unique_ptr<PoseSource>
  poses()
  {
    return std::make_unique<KnownPoses>(
        [](int number) { return renderer_->pose(number); });
  }

  static std::unique_ptr<LabelPredictor>
  labels()
  {
    return std::make_unique<KnownLabels>([](int number) {
      return syntheticDistributions(views_[std::size_t(number)], 3);
    });
  }

  static SemanticMapper
  makeMapper(const MapperConfig& config, std::unique_ptr<LabelPredictor> labels)
  {
    return SemanticMapper(kitti11(), config, poses(), renderer_->camera(),
                          std::move(labels));
  }

  static SemanticMapper
  makeMapper(const MapperConfig& config)
  {
    return makeMapper(config, labels());
  }

  static StereoFrame
  frame(int i)
  {
    return {{i, 0.1 * i}, views_[std::size_t(i)].left, views_[std::size_t(i)].right};
  }

  static inline std::unique_ptr<SyntheticRenderer> renderer_;
  static inline std::vector<SyntheticView> views_;
};

double
meanIoU(const cv::Mat& prediction, const cv::Mat& truth, const cv::Mat& covered_by)
{
  ConfusionMatrix confusion(synthetic_classes);
  cv::Mat masked_truth = truth.clone();
  masked_truth.setTo(0, covered_by == 0);
  confusion.add(masked_truth, prediction);
  return computeScores(confusion, {1, 3, 4, 5, 6, 9, 10, 11}).mean.iou_exclusive;
}

TEST_F(Street, PairsNeedTheirCamera)
{
  expectBadParameter("need their camera", [] {
    SemanticMapper(kitti11(), MapperConfig(), poses(), std::nullopt, labels());
  });
}

TEST_F(Street, TheMapLabelsBetterThanTheNetwork)
{
  SemanticMapper mapper = makeMapper(MapperConfig());
  double network = 0.0, mapped = 0.0, covered = 0.0;
  for (int i = 0; i < frames; ++i) {
    const MappedFrame result = mapper.process(frame(i));
    const SyntheticView& view = views_[std::size_t(i)];
    const cv::Mat labels =
        renderLabels(result.voxels, view.camera, result.T_world_camera, 40.0).labels;
    const cv::Mat at_depth =
        labelsAtDepth(mapper.map(), *result.cloud, result.T_world_camera, 40.0);
    cv::Mat network_labels(view.labels.size(), CV_8UC1);
    for (Eigen::Index j = 0; j < result.network.size(); ++j)
      network_labels.data[j] = result.network.mapLabel(j);
    if (i == 0)
      continue; // nothing to fuse yet
    network += meanIoU(network_labels, view.labels, at_depth);
    mapped += meanIoU(at_depth, view.labels, at_depth);
    covered += double(cv::countNonZero(labels)) / double(labels.total());
  }
  EXPECT_GT(mapped, network + 0.03 * (frames - 1)) << "less than 3 points gained";
  EXPECT_GT(covered / (frames - 1), 0.5);
}

TEST_F(Street, WhoLooksOnSeesEachFrameUntilTheMapIsFinished)
{
  MappingRun run;
  run.label_set = kitti11();
  run.frames = {0, 2};
  run.config.crf = CRFModelType::unary;
  SemanticMapper mapper = makeMapper(run.config);
  const TemporaryFolder folder;
  MappingOutput output(folder.path(), run);
  const std::string live = folder.path("live");
  for (const int number : run.frames) {
    const MappedFrame mapped = mapper.process(frame(number));
    output.writeFrame(mapped, mapper.map());
    output.writeLive(mapped);
    // Places are voxels of the map's grid, whose corner lies at the world's origin.
    const VoxelScene seen = readVoxelScene(
        live + "/map.pcd", {mapped.voxels.voxel_size, -mapped.voxels.origin});
    EXPECT_EQ(seen.voxels.indices, mapped.voxels.indices);
    EXPECT_EQ(readKittiTrajectory(live + "/trajectory.txt").size(), number + 1u);
    EXPECT_TRUE(fs::exists(live + "/label_set.yaml"));
    EXPECT_TRUE(fs::exists(live + "/summary.json"));
  }
  output.finish(mapper.map());
  EXPECT_FALSE(fs::exists(live));
}

TEST_F(Street, WhoLooksOnSeesCentresIfTheMapWillHaveThem)
{
  MappingRun run;
  run.label_set = kitti11();
  run.frames = {0};
  run.config.crf = CRFModelType::unary;
  SemanticMapper mapper = makeMapper(run.config);
  const TemporaryFolder folder;
  ExtraOptions extra;
  extra.centres = true;
  MappingOutput output(folder.path(), run, {}, extra);
  const MappedFrame mapped = mapper.process(frame(0));
  output.writeFrame(mapped, mapper.map());
  output.writeLive(mapped);
  const auto seen = readLabelledCloud(folder.path("live/map.pcd")).cloud;
  ASSERT_EQ(seen->size(), mapped.voxels.size());
  std::size_t moved = 0;
  for (std::size_t i = 0; i < seen->size(); ++i) {
    const Eigen::Vector3f centre = mapped.voxels.centre(i);
    EXPECT_EQ((*seen)[i].getVector3fMap(), centre);
    moved += (*mapped.voxels.cloud)[i].getVector3fMap() != centre;
  }
  EXPECT_GT(moved, seen->size() / 2) << "the points of the frame were moved";
}

TEST_F(Street, TheCallbackSeesEveryFrameAndTheMapAsItStands)
{
  MapperConfig config;
  config.crf = CRFModelType::unary;
  SemanticMapper mapper = makeMapper(config);
  std::vector<int> seen;
  mapper.setCallback([&](const MappedFrame& mapped, const SemanticVoxelMap& map) {
    seen.push_back(mapped.frame.number);
    EXPECT_EQ(map.occupied().size(), mapped.voxels.size());
  });
  mapper.process(frame(0));
  mapper.process(frame(2));
  EXPECT_EQ(seen, (std::vector<int>{0, 2}));
}

TEST_F(Street, TheCrfRunsEveryNthFrameAndKeepsTheMeasurements)
{
  MapperConfig config;
  config.crf_every = 2;
  SemanticMapper mapper = makeMapper(config);
  const MappedFrame with = mapper.process(frame(0));
  EXPECT_FALSE(with.voxels.refined.matrix() == with.voxels.measured.matrix());
  const MappedFrame without = mapper.process(frame(1));
  for (const auto& [stage, seconds] : without.times.seconds())
    EXPECT_NE(stage, "crf");
  const VoxelCloud before = mapper.map().occupied();
  mapper.finish();
  const VoxelCloud after = mapper.map().occupied();
  EXPECT_TRUE(before.measured.matrix() == after.measured.matrix());
  int unrefined_before = 0, unrefined_after = 0;
  for (Eigen::Index i = 0; i < after.refined.size(); ++i) {
    unrefined_before +=
        before.refined.matrix().col(i) == before.measured.matrix().col(i);
    unrefined_after += after.refined.matrix().col(i) == after.measured.matrix().col(i);
  }
  EXPECT_GT(unrefined_before, int(after.size()) / 4);
  EXPECT_LT(unrefined_after, int(after.size()) / 100);
}

TEST_F(Street, OnlyEveryNthPairIsLabelled)
{
  MapperConfig config;
  config.crf = CRFModelType::unary;
  SemanticMapper all = makeMapper(config);
  config.network_every = 3;
  SemanticMapper some = makeMapper(config);
  for (int i = 0; i < frames; ++i) {
    const MappedFrame expected = all.process(frame(i));
    const MappedFrame mapped = some.process(frame(i));
    EXPECT_EQ(mapped.network.empty(), i % 3 != 0) << i;
    // Without labels the sky counts as a hit.
    EXPECT_EQ(mapped.counts.sky, i % 3 == 0 ? expected.counts.sky : 0u) << i;
    EXPECT_GE(mapped.counts.rays, expected.counts.rays) << i;
    const auto unlabelled = (mapped.voxels.measured.matrix().array() == 0.0f);
    EXPECT_EQ(unlabelled.colwise().all().any(), i > 0) << i;
  }
}

// The predictions of a frame arrive late.
TEST_F(Street, LabelsMayComeLater)
{
  MapperConfig config;
  config.crf = CRFModelType::unary;
  config.map.fusion.free_dynamic = false; // it depends on the labels of a scan
  SemanticMapper at_once = makeMapper(config);
  SemanticMapper later = makeMapper(config, std::make_unique<NoLabels>());
  LateLabels late(labels(), later);
  for (int i = 0; i < frames; ++i) {
    at_once.process(frame(i));
    late.offer(later.process(frame(i)));
    EXPECT_TRUE(late.fuseLast()) << i;
    EXPECT_FALSE(late.fuseLast()) << i;
  }
  EXPECT_EQ(late.frames(), frames);
  later.finish();
  // Without labels the sky counts as a hit; all other values equal those with labels.
  const VoxelCloud expected = at_once.map().occupied(), found = later.map().occupied();
  std::map<std::array<int, 3>, std::size_t> at;
  for (std::size_t i = 0; i < found.size(); ++i)
    at[{found.indices[i].x(), found.indices[i].y(), found.indices[i].z()}] = i;
  std::size_t in_both = 0, equal = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const VoxelIndex& voxel = expected.indices[i];
    const auto same = at.find({voxel.x(), voxel.y(), voxel.z()});
    if (same == at.end())
      continue; // a ray to the sky has cleared it
    ++in_both;
    equal += expected.measured.matrix().col(Eigen::Index(i)) ==
             found.measured.matrix().col(Eigen::Index(same->second));
  }
  EXPECT_GT(in_both, expected.size() * 9 / 10);
  EXPECT_EQ(equal, in_both);
}

TEST_F(Street, ANetworkThatIsBusyLeavesFramesWithoutLabels)
{
  MapperConfig config;
  config.crf = CRFModelType::unary;
  SemanticMapper mapper = makeMapper(config, std::make_unique<NoLabels>());
  std::promise<void> end; // until then it works on frame 0
  std::vector<int> seen;
  auto slow = std::make_unique<KnownLabels>(
      [&seen, end = end.get_future().share()](int number) {
        seen.push_back(number);
        end.wait();
        return syntheticDistributions(views_[std::size_t(number)], 3);
      });
  LateLabels late(std::move(slow), mapper);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(late.fuseReady()) << i;
    const MappedFrame mapped = mapper.process(frame(i));
    EXPECT_TRUE(mapped.voxels.measured.matrix().isZero(0.0f)) << i;
    late.offer(mapped);
  }
  end.set_value();
  EXPECT_TRUE(late.fuseLast());
  EXPECT_EQ(seen, std::vector<int>{0});
  EXPECT_FALSE(mapper.map().occupied().measured.matrix().isZero(0.0f));
  expectBadParameter("labels of 7 pixels", [&] {
    mapper.addLabels(mapper.process(frame(3)), LabelDistributions(11, 7));
  });
}

TEST_F(Street, TheCrfWritesBackWhatItConcludesOnRequest)
{
  MapperConfig config;
  config.crf_parameters.temperature = 1.0;
  SemanticMapper apart = makeMapper(config);
  config.crf_write_back = true;
  config.crf_parameters.temperature = 3.0; // not the written-back distributions
  SemanticMapper back = makeMapper(config);
  const MappedFrame first_apart = apart.process(frame(0));
  const MappedFrame first = back.process(frame(0));
  // A frame's CRF starts from the same measurements; only the stored result differs.
  EXPECT_TRUE(first.voxels.measured.matrix() == first_apart.voxels.measured.matrix());
  EXPECT_TRUE(first.voxels.refined.matrix() == first_apart.voxels.refined.matrix());
  const VoxelCloud kept = back.map().occupied();
  EXPECT_LT((kept.measured.matrix() - kept.refined.matrix()).cwiseAbs().maxCoeff(),
            0.002f); // except for the clamp
  EXPECT_TRUE(apart.map().occupied().measured.matrix() ==
              first_apart.voxels.measured.matrix());

  const MappedFrame second_apart = apart.process(frame(1));
  const MappedFrame second = back.process(frame(1));
  ASSERT_EQ(second.voxels.indices, second_apart.voxels.indices);
  EXPECT_FALSE(second.voxels.measured.matrix() ==
               second_apart.voxels.measured.matrix());
}

TEST_F(Street, RimsThatAreLookedPastAreNotMapped)
{
  MapperConfig config;
  config.crf = CRFModelType::unary;
  config.min_hit_ratio = 0.0;
  const MappedFrame all = makeMapper(config).process(frame(0));
  config.min_hit_ratio = 0.33;
  const MappedFrame fewer = makeMapper(config).process(frame(0));
  auto rest = *all.cloud;
  const std::size_t erased = eraseSeenThrough(
      rest, renderer_->camera(), all.T_world_camera, config.map.voxel_size, 0.33);
  SemanticVoxelMap expected(kitti11(), config.map);
  expected.integrate(rest, all.T_world_camera, all.network);
  EXPECT_LT(fewer.voxels.size(), all.voxels.size());
  EXPECT_EQ(all.counts.seen_through, 0u);
  EXPECT_EQ(fewer.counts.seen_through, erased);
  EXPECT_EQ(fewer.counts.invalid, all.counts.invalid); // those without depth
  EXPECT_EQ(fewer.voxels.indices, expected.occupied().indices);
  // The frame itself stays as it was measured: its pixels still look up the map.
  for (std::size_t i = 0; i < all.cloud->size(); ++i)
    EXPECT_EQ(std::isnan((*fewer.cloud)[i].z), std::isnan((*all.cloud)[i].z));
}

TEST_F(Street, EveryModelOfTheCrf)
{
  std::vector<Eigen::MatrixXf> refined;
  for (const CRFModelType model :
       {CRFModelType::unary, CRFModelType::dense, CRFModelType::pn_potts,
        CRFModelType::hierarchical}) {
    MapperConfig config;
    config.crf = model;
    config.crf_parameters.iterations = 3;
    config.cliques = "cubes:1";
    SemanticMapper mapper = makeMapper(config);
    const MappedFrame mapped = mapper.process(frame(0));
    refined.push_back(mapped.voxels.refined.matrix());
    // The mapper's result is the filter's.
    if (config.crf == CRFModelType::unary) {
      EXPECT_EQ(refined[0], mapped.voxels.measured.matrix());
      continue;
    }
    SemanticCRF<pcl::PointXYZRGBL> crf;
    crf.setModel(config.crf);
    config.crf_parameters.sensor = PointSensor::stereo;
    crf.setParameters(config.crf_parameters);
    crf.setThinLabels(mapper.map().labelSet().thinLabels());
    crf.setCliqueGenerator(std::make_shared<CubeCliques>(1.0));
    crf.setInputCloud(mapped.voxels.cloud);
    crf.setLabelDistributions(mapped.voxels.measured);
    crf.setVoxels(mapped.voxels.indices, mapped.voxels.voxel_size);
    pcl::PointCloud<pcl::PointXYZRGBL> output;
    crf.filter(output);
    EXPECT_EQ(crf.getLabelDistributions().matrix(), refined.back()) << nameOf(model);
  }
  for (std::size_t i = 1; i < refined.size(); ++i)
    EXPECT_GT((refined[i] - refined[i - 1]).cwiseAbs().maxCoeff(), 0.1f) << i;
}

TEST_F(Street, SameMapForAnyNumberOfThreads)
{
  std::vector<VoxelCloud> maps;
  for (const int threads : {1, 2, 7}) {
    MapperConfig config;
    config.threads = threads;
    SemanticMapper mapper = makeMapper(config);
    for (int i = 0; i < 2; ++i)
      mapper.process(frame(i));
    maps.push_back(mapper.map().occupied());
  }
  for (const VoxelCloud& other : {maps[1], maps[2]}) {
    ASSERT_EQ(other.size(), maps[0].size());
    EXPECT_TRUE(other.refined.matrix() == maps[0].refined.matrix());
    EXPECT_TRUE(other.measured.matrix() == maps[0].measured.matrix());
  }
}

// Each in a thread of its own, with threads of its own.
TEST_F(Street, TwoMappersInOneProcessDoNotDisturbEachOther)
{
  const auto mapWith = [](int threads) {
    MapperConfig config;
    config.threads = threads;
    SemanticMapper mapper = makeMapper(config);
    for (int i = 0; i < 3; ++i)
      mapper.process(frame(i));
    return mapper.map().occupied();
  };
  const VoxelCloud alone = mapWith(1);
  std::future<VoxelCloud> both[2];
  for (int each = 0; each < 2; ++each)
    both[each] = std::async(std::launch::async, mapWith, each + 1);
  for (std::future<VoxelCloud>& each : both) {
    const VoxelCloud voxels = each.get();
    EXPECT_EQ(voxels.indices, alone.indices);
    EXPECT_TRUE(voxels.refined.matrix() == alone.refined.matrix());
  }
}

TEST_F(Street, ABlankPairIsMappedAsNothing)
{
  SemanticMapper mapper = makeMapper(MapperConfig());
  const cv::Mat blank(128, 416, CV_8UC3, cv::Scalar(80, 80, 80));
  const MappedFrame result = mapper.process(StereoFrame{{0, 0.0}, blank, blank});
  EXPECT_EQ(result.counts.rays, 0u);
  EXPECT_EQ(result.voxels.size(), 0u);
}

TEST_F(Street, RefusesAConfigThatCannotWork)
{
  MapperConfig config;
  config.cliques = "densest";
  EXPECT_THROW(makeMapper(config), InvalidParameterException);
  config = MapperConfig();
  config.disparities = 100;
  EXPECT_THROW(makeMapper(config), InvalidParameterException);
}

} // namespace
