// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <gtest/gtest.h>

#include <cstdlib>

namespace {

using namespace pcl_semantic;

struct Street {
  StereoCamera camera;
  std::vector<StereoFrame> frames;
  std::vector<Eigen::Isometry3d> T_world_camera;
};

// Fourteen frames: 11 m, the last of them in a turn; as the test
// odometry.odometry_street has left them.
const Street&
street()
{
  static const Street made = [] {
    const SyntheticScene scene(1, 14);
    const SyntheticRenderer renderer(scene, 496, 150);
    const KittiSequence sequence(PCL_SEMANTIC_BINARY_DIR "/test/odometry_street");
    Street result;
    result.camera = renderer.camera();
    for (int i = 0; i < scene.frames(); ++i) {
      result.frames.push_back(sequence.frame(std::size_t(i)));
      result.T_world_camera.push_back(renderer.pose(i));
    }
    return result;
  }();
  return made;
}

Eigen::Isometry3d
cameraInCamera0()
{
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  T_camera0_camera.translation().x() = SyntheticRenderer::camera_2_offset;
  return T_camera0_camera;
}

StereoFrame
blank(const StereoFrame& frame)
{
  StereoFrame result = frame;
  result.left = cv::Mat(frame.left.size(), CV_8UC3, cv::Scalar::all(128));
  result.right = result.left.clone();
  return result;
}

double
distance(const Eigen::Isometry3d& one, const Eigen::Isometry3d& two)
{
  return (one.translation() - two.translation()).norm();
}

} // namespace

TEST(StereoOdometry, FollowsTheStreet)
{
  StereoOdometry odometry(street().camera, cameraInCamera0());
  for (std::size_t i = 0; i < street().frames.size(); ++i) {
    const OdometryResult& result = odometry.process(street().frames[i]);
    EXPECT_FALSE(result.is_lost);
    EXPECT_LT(distance(result.T_world_camera, street().T_world_camera[i]),
              0.01 * 0.85 * double(i) + 1e-9)
        << i;
    EXPECT_LT(Eigen::AngleAxisd(result.T_world_camera.linear().transpose() *
                                street().T_world_camera[i].linear())
                  .angle(),
              0.003)
        << i;
  }
  EXPECT_EQ(odometry.lostFrames(), 0);
}

TEST(StereoOdometry, ItsErrorsAreAsLargeAsItSays)
{
  StereoOdometry odometry(street().camera, cameraInCamera0());
  double trace = 0.0;
  for (std::size_t i = 0; i < street().frames.size(); ++i) {
    const OdometryResult& result = odometry.process(street().frames[i]);
    const Eigen::Matrix<double, 6, 6> covariance = result.covariance;
    EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-9));
    EXPECT_GE(covariance.trace(), trace); // it grows
    trace = covariance.trace();
    const double deviation = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    EXPECT_LE(distance(result.T_world_camera, street().T_world_camera[i]),
              8.0 * deviation + 1e-9)
        << i;
    EXPECT_LT(deviation, 0.1) << i;
  }
}

TEST(StereoOdometry, ThePosesDoNotDependOnThreads)
{
  std::vector<Eigen::Isometry3d> first;
  for (const int threads : {1, 2, 5}) {
    setNumberOfThreads(threads);
    StereoOdometry odometry(street().camera);
    for (std::size_t i = 0; i < 6; ++i) {
      const Eigen::Isometry3d pose = odometry.pose(street().frames[i]);
      if (threads == 1)
        first.push_back(pose);
      EXPECT_EQ(pose.matrix(), first[i].matrix());
    }
  }
  setNumberOfThreads(0);
}

TEST(StereoOdometry, GoesOnFromThePredictionAfterALoss)
{
  StereoOdometry odometry(street().camera, cameraInCamera0());
  double before = 0.0;
  for (std::size_t i = 0; i < street().frames.size(); ++i) {
    const bool is_blank = i == 6 || i == 7;
    const OdometryResult& result =
        odometry.process(is_blank ? blank(street().frames[i]) : street().frames[i]);
    // The first frame after the blank ones has nothing to be compared with.
    EXPECT_EQ(result.is_lost, is_blank || i == 8) << i;
    EXPECT_TRUE(!result.is_lost || result.covariance.trace() > before + 0.05) << i;
    before = result.covariance.trace();
    EXPECT_LT(distance(result.T_world_camera, street().T_world_camera[i]),
              i < 6 ? 0.06 : 0.3)
        << i;
  }
  EXPECT_EQ(odometry.lostFrames(), 3);
}

TEST(StereoOdometry, AGapInTheFramesIsALongerStep)
{
  StereoOdometry odometry(street().camera, cameraInCamera0());
  for (const std::size_t i : {0u, 1u, 2u, 3u, 5u, 6u, 7u})
    EXPECT_LT(distance(odometry.pose(street().frames[i]), street().T_world_camera[i]),
              0.06)
        << i;
  EXPECT_EQ(odometry.lostFrames(), 0);
}

TEST(StereoOdometry, StandingStillStaysInPlace)
{
  StereoOdometry odometry(street().camera, cameraInCamera0());
  for (int i = 0; i < 5; ++i) {
    StereoFrame frame = street().frames[0];
    frame.number = i;
    frame.timestamp = 0.1 * i;
    EXPECT_LT(distance(odometry.pose(frame), street().T_world_camera[0]), 1e-3);
    EXPECT_EQ(odometry.process(frame).is_keyframe, i == 0);
  }
}

TEST(StereoOdometry, AFrameThatComesTwiceChangesNothing)
{
  StereoOdometry odometry(street().camera);
  odometry.pose(street().frames[0]);
  const Eigen::Isometry3d pose = odometry.pose(street().frames[1]);
  EXPECT_EQ(odometry.pose(street().frames[1]).matrix(), pose.matrix());
}

TEST(StereoOdometry, NamesTheFrameOfImagesThatDoNotFit)
{
  StereoFrame narrow = street().frames[3], wide = narrow, deep = narrow;
  narrow.right = narrow.right.colRange(0, 400);
  wide.left = wide.right = cv::Mat(200, 600, CV_8UC3, cv::Scalar::all(0));
  deep.left = deep.right = cv::Mat(150, 496, CV_16UC1, cv::Scalar::all(0));
  for (const StereoFrame& frame : {narrow, wide, deep, StereoFrame{{3, 0.0}, {}, {}}}) {
    StereoOdometry odometry(street().camera);
    expectBadInput("frame 3: ", [&] { odometry.process(frame); });
  }
}

TEST(StereoOdometry, RefusesParametersOutOfRange)
{
  Eigen::Isometry3d scaled = Eigen::Isometry3d::Identity();
  scaled.linear() *= 2.0;
  EXPECT_THROW(StereoOdometry(street().camera, scaled), BadInputException);
  const auto refused = [](auto change) {
    StereoOdometry::Parameters parameters;
    change(parameters);
    thrownMessage<InvalidParameterException>([&] { parameters.validate(); });
  };
  using P = StereoOdometry::Parameters;
  StereoOdometry::Parameters().validate();
  refused([](P& p) { p.features = 0; });
  refused([](P& p) { p.window = 1; });
  refused([](P& p) { p.iterations = 0; });
  refused([](P& p) { p.minimum_inliers = 2; });
  refused([](P& p) { p.max_disparity = -1; });
  refused([](P& p) { p.keyframe_flow = std::nan(""); });
  refused([](P& p) { p.pixel_noise = 0.0; });
  refused([](P& p) { p.disparity_noise = -1.0; });
  refused([](P& p) { p.offset_drift = -1.0; });
}

// The ground truth of the first frames is interpolated (doc/odometry.md); the shape of
// the path is right all along.
TEST(StereoOdometry, FollowsKitti06)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "PCL_SEMANTIC_DATA is not set";
  const KittiSequence sequence(std::string(data) + "/kitti_gray/06");
  const Trajectory truth = readKittiTrajectory(sequence.posesPath());
  StereoOdometry odometry(sequence.camera());
  Eigen::Isometry3d first = Eigen::Isometry3d::Identity(), last = first;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    last = worldFromFirstCamera().inverse() * odometry.pose(sequence.frame(i));
    if (i == 12)
      first = last;
  }
  const Eigen::Isometry3d error =
      (first.inverse() * last).inverse() * truth[12].inverse() * truth[50];
  EXPECT_LT(error.translation().norm(), 0.01 * 45.5);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.004 * 45.5 * M_PI / 180.0);
  EXPECT_EQ(odometry.lostFrames(), 0);
}
