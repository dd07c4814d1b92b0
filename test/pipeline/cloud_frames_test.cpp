// SPDX-License-Identifier: BSD-3-Clause
#include "support/stored_trajectory.h"
#include "support/street_scans.h"
#include "support/thrown_message.h"

#include <pcl_semantic/map/seen_through.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

constexpr int width = 208, height = 64;

class CloudFrames : public testing::Test {
protected:
  void
  SetUp() override
  {
    scans_ = makeStreetScans(2, width, height);
    camera_ = SyntheticRenderer(SyntheticScene(1, 2), width, height).camera();
    config_.crf = CRFModelType::unary;
    label_set_ = readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
  }

  std::unique_ptr<SemanticMapper>
  makeMapper(const std::optional<StereoCamera>& camera) const
  {
    Trajectory poses;
    for (const StreetScan& scan : scans_)
      poses.push_back(worldFromFirstCamera().inverse() * scan.T_world_camera);
    return std::make_unique<SemanticMapper>(label_set_, config_,
                                            posesOf(storedTrajectory(poses)), camera);
  }

  CloudFrame
  frame(int i) const
  {
    const StreetScan& scan = scans_[std::size_t(i)];
    return {{i, 0.1 * i}, scan.cloud, scan.distributions, true};
  }

  std::vector<StreetScan> scans_;
  StereoCamera camera_;
  MapperConfig config_;
  LabelSet label_set_;
};

} // namespace

TEST_F(CloudFrames, AnySensorsCloudGoesInAsItIs)
{
  const auto mapper = makeMapper(std::nullopt);
  SemanticVoxelMap expected(label_set_, config_.map);
  for (int i = 0; i < 2; ++i) {
    const MappedFrame mapped = mapper->process(frame(i));
    EXPECT_EQ(mapped.frame.number, i);
    EXPECT_TRUE(mapped.image.empty());
    const StreetScan& scan = scans_[std::size_t(i)];
    expected.integrate(*scan.cloud, mapped.T_world_camera, scan.distributions);
    EXPECT_TRUE(mapped.T_world_camera.isApprox(scan.T_world_camera, 1e-12));
  }
  const VoxelCloud voxels = mapper->map().occupied(), others = expected.occupied();
  EXPECT_EQ(voxels.indices, others.indices);
  EXPECT_TRUE(voxels.measured.matrix() == others.measured.matrix());
  EXPECT_GT(voxels.size(), 1000u);
}

TEST_F(CloudFrames, OfACameraLoseWhatIsSeenThroughAndKeepTheImage)
{
  const MappedFrame mapped = makeMapper(camera_)->process(frame(0));
  auto rest = *scans_[0].cloud;
  const std::size_t erased =
      eraseSeenThrough(rest, camera_, mapped.T_world_camera, config_.map.voxel_size,
                       config_.min_hit_ratio);
  EXPECT_GT(erased, 0u);
  EXPECT_EQ(mapped.counts.seen_through, erased);
  ASSERT_EQ(mapped.image.size(), cv::Size(width, height));
  const pcl::PointXYZRGB& point = (*scans_[0].cloud)[5 * width + 7];
  EXPECT_EQ(mapped.image.at<cv::Vec3b>(5, 7), cv::Vec3b(point.b, point.g, point.r));
}

// A scanner's empty scan, and a camera's frame without a depth.
TEST_F(CloudFrames, OfNoPointsChangeNothing)
{
  for (const bool has_camera : {false, true}) {
    const auto mapper = makeMapper(has_camera ? std::optional(camera_) : std::nullopt);
    const VoxelCloud before = mapper->process(frame(0)).voxels;
    CloudFrame empty = frame(1);
    empty.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
    empty.distributions = LabelDistributions();
    const MappedFrame mapped = mapper->process(empty);
    EXPECT_EQ(mapped.counts.rays, 0u);
    EXPECT_EQ(mapped.image.empty(), !has_camera);
    EXPECT_EQ(mapper->map().occupiedEverywhere().size(), before.size());
  }
}

TEST_F(CloudFrames, PointsAtTheSensorAreNoReturns)
{
  for (const bool has_camera : {false, true}) {
    CloudFrame zeros = frame(0), nans = frame(0);
    for (CloudFrame* const each : {&zeros, &nans})
      each->cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(*each->cloud);
    for (std::size_t i = 0; i < 500; ++i) {
      (*zeros.cloud)[7 * i].getVector3fMap().setZero();
      (*nans.cloud)[7 * i].getVector3fMap().setConstant(std::nanf(""));
    }
    const auto camera = has_camera ? std::optional(camera_) : std::nullopt;
    const MappedFrame of_zeros = makeMapper(camera)->process(zeros),
                      of_nans = makeMapper(camera)->process(nans);
    EXPECT_EQ(of_zeros.counts.invalid, of_nans.counts.invalid);
    EXPECT_GE(of_zeros.counts.invalid, 500u);
    EXPECT_EQ(of_zeros.voxels.indices, of_nans.voxels.indices);
  }
}

TEST_F(CloudFrames, ColoursThatMeanNothingAreNotFused)
{
  CloudFrame grey = frame(0);
  grey.has_colour = false;
  const auto mapper = makeMapper(std::nullopt);
  const VoxelCloud voxels = mapper->process(grey).voxels;
  pcl::PointCloud<pcl::PointXYZ> places;
  for (const pcl::PointXYZRGB& point : *grey.cloud)
    places.emplace_back(point.x, point.y, point.z);
  SemanticVoxelMap expected(label_set_, config_.map);
  expected.integrate(places, scans_[0].T_world_camera, scans_[0].distributions);
  const VoxelCloud others = expected.occupied();
  ASSERT_EQ(voxels.indices, others.indices);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    ASSERT_EQ((*voxels.cloud)[i].rgba, (*others.cloud)[i].rgba);
}

TEST_F(CloudFrames, ACloudAndASourceOfPosesAreNeeded)
{
  const auto mapper = makeMapper(std::nullopt);
  expectBadParameter("frame 1: has no cloud", [&] {
    mapper->process(CloudFrame{{1, 0.1}, nullptr, {}, true});
  });
  expectBadParameter("poses", [&] { SemanticMapper(label_set_, config_, nullptr); });
}

TEST_F(CloudFrames, WhatNeedsACameraIsRefused)
{
  const auto mapper = makeMapper(std::nullopt);
  expectBadParameter("made for clouds alone", [&] { mapper->process(StereoFrame()); });
  CloudFrame other = frame(0);
  other.cloud->width = 104;
  other.cloud->height = 128;
  expectBadInput(
      "frame 0: the cloud is 104 x 128, expected that of the camera, 208 x 64",
      [&] { makeMapper(camera_)->process(other); });
  config_.max_deviation = 0.5;
  expectBadParameter("max_deviation and deviation_scale are for stereo",
                     [&] { makeMapper(camera_); });
  config_.max_deviation = 0.0;
  config_.crf = CRFModelType::hierarchical;
  config_.cliques = "superpixel";
  expectBadParameter("superpixels are for clouds of a camera",
                     [&] { makeMapper(std::nullopt); });
  EXPECT_NO_THROW(makeMapper(camera_));
}

} // namespace pcl_semantic
