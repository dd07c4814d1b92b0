// SPDX-License-Identifier: BSD-3-Clause
#include "support/same_image.h"
#include "support/temporary_folder.h"
#include "synthesize/labels.h"
#include "synthesize/room_writer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <array>
#include <cmath>

using namespace pcl_semantic;

namespace {

constexpr int kWidth = 128, kHeight = 96;

RoomView
renderView(std::uint32_t seed, int frame, int frames = 40)
{
  return RoomRenderer(SyntheticRoom(seed, frames), kWidth, kHeight).render(frame);
}

Eigen::Vector3d
worldPoint(const RoomView& view, int u, int v)
{
  return view.T_world_camera * view.camera.unproject(u, v, view.depth.at<float>(v, u));
}

int
countMistakes(const RoomView& view, double noise)
{
  const LabelDistributions distributions = syntheticDistributions(view, 1, noise);
  int wrong = 0;
  for (Eigen::Index i = 0; i < distributions.size(); ++i)
    wrong += distributions.mapLabel(i) != view.labels.ptr<Label>()[i];
  return wrong;
}

} // namespace

TEST(SyntheticRoom, ClassesAreThoseOfTheLabelSetFile)
{
  const LabelSet set =
      readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/nyu13.yaml");
  ASSERT_EQ(set.size(), room_classes);
  const char* const names[] = {"bed",       "books",   "ceiling", "chair", "floor",
                               "furniture", "objects", "picture", "sofa",  "table",
                               "tv",        "wall",    "window"};
  for (int label = room_bed; label <= room_window; ++label)
    EXPECT_EQ(set.find(names[label - 1]), label);
}

TEST(SyntheticRoom, IsClosedAndShowsEveryClass)
{
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    std::array<int, room_classes + 1> seen{};
    const SyntheticRoom room(seed);
    const RoomRenderer renderer(room, kWidth, kHeight);
    for (int frame = 0; frame < room.frames(); frame += 4) {
      const RoomView view = renderer.render(frame);
      double nearest = 0.0, farthest = 0.0;
      cv::minMaxLoc(view.depth, &nearest, &farthest);
      EXPECT_GT(nearest, 0.3) << "seed " << seed << " frame " << frame;
      EXPECT_LT(farthest, 7.0) << "seed " << seed << " frame " << frame;
      for (std::size_t i = 0; i < view.labels.total(); ++i)
        ++seen[view.labels.ptr<Label>()[i]];
    }
    EXPECT_EQ(seen[kUnlabelled], 0);
    for (int label = 1; label <= room_classes; ++label)
      EXPECT_GT(seen[std::size_t(label)], 100) << "seed " << seed << " class " << label;
  }
}

TEST(SyntheticRoom, CameraMakesOneTurn)
{
  const SyntheticRoom room(1, 50);
  double turned = 0.0;
  for (int frame = 0; frame < 50; ++frame) {
    const Eigen::Isometry3d pose = room.pose(frame);
    ASSERT_NEAR(
        (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity())
            .norm(),
        0.0, 1e-12);
    ASSERT_NEAR(pose.linear().determinant(), 1.0, 1e-12);
    const Eigen::Isometry3d next = room.pose((frame + 1) % 50);
    const Eigen::Isometry3d step = pose.inverse() * next;
    EXPECT_LT(step.translation().norm(), 0.25) << frame;
    turned += Eigen::AngleAxisd(step.linear()).angle();
  }
  EXPECT_NEAR(turned, 2.0 * M_PI, 0.3);
}

TEST(SyntheticRoom, RefusesWhatItCannotRender)
{
  EXPECT_THROW(SyntheticRoom(1, 0), InvalidParameterException);
  EXPECT_THROW(SyntheticRoom(1, 100001), InvalidParameterException);
  const SyntheticRoom room(1, 2);
  EXPECT_THROW(room.pose(-1), InvalidParameterException);
  EXPECT_THROW(room.pose(2), InvalidParameterException);
  for (const cv::Size size :
       {cv::Size(63, 32), cv::Size(64, 31), cv::Size(4097, 32), cv::Size(64, 4097)})
    EXPECT_THROW(RoomRenderer(room, size.width, size.height),
                 InvalidParameterException);
}

// A ray from another camera to a point meets the point or a nearer surface.
TEST(SyntheticRoom, ViewsAgree)
{
  const SyntheticRoom room(3);
  const RoomRenderer renderer(room, kWidth, kHeight);
  const RoomView view = renderer.render(10);
  const Eigen::Vector3d other = room.pose(14).translation();
  int met = 0, behind = 0, points = 0;
  for (int v = 0; v < kHeight; v += 2)
    for (int u = 0; u < kWidth; u += 2) {
      const Eigen::Vector3d point = worldPoint(view, u, v);
      synthetic::Surface surface;
      ASSERT_TRUE(room.nearest({other, point - other}, surface));
      ++points;
      behind += surface.distance > 1.01;
      if (std::abs(surface.distance - 1.0) * (point - other).norm() < 1e-3) {
        ++met;
        EXPECT_EQ(surface.label, view.labels.at<Label>(v, u)) << u << " " << v;
      }
    }
  EXPECT_GT(met, points / 3);
  EXPECT_LE(behind, points / 100) << "bushes are met approximately";
}

TEST(SyntheticRoom, BytesDependOnTheSeedAndNotOnTheThreads)
{
  setNumberOfThreads(1);
  const RoomView one = renderView(5, 7);
  const cv::Mat one_depth = measuredDepth(one, 5);
  const LabelDistributions one_labels = syntheticDistributions(one, 5);
  setNumberOfThreads(3);
  const RoomView other = renderView(5, 7);
  for (const auto image : {&RoomView::colour, &RoomView::depth, &RoomView::labels})
    EXPECT_TRUE(isSameImage(one.*image, other.*image));
  EXPECT_TRUE(isSameImage(one_depth, measuredDepth(other, 5)));
  EXPECT_EQ(one_labels.matrix(), syntheticDistributions(other, 5).matrix());
  setNumberOfThreads(0);
  EXPECT_FALSE(isSameImage(one.depth, renderView(6, 7).depth));
  EXPECT_FALSE(isSameImage(one_depth, measuredDepth(one, 6)));
}

TEST(SyntheticRoom, DepthNoiseHasTheStatedDeviation)
{
  const RoomView view = renderView(2, 3);
  const cv::Mat exact = measuredDepth(view, 1, 0.0);
  const cv::Mat noisy = measuredDepth(view, 1);
  double sum = 0.0, square = 0.0;
  for (std::size_t i = 0; i < view.depth.total(); ++i) {
    const double z = view.depth.ptr<float>()[i];
    ASSERT_NEAR(exact.ptr<std::uint16_t>()[i], 1000.0 * z, 0.501);
    const double deviation = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    const double error = (noisy.ptr<std::uint16_t>()[i] / 1000.0 - z) / deviation;
    sum += error;
    square += error * error;
  }
  const double count = double(view.depth.total());
  EXPECT_NEAR(sum / count, 0.0, 0.03);
  EXPECT_NEAR(std::sqrt(square / count), 1.0,
              0.05); // and half a millimetre of rounding
}

TEST(SyntheticRoom, LabelsAreDistributionsWithMoreMistakesForMoreNoise)
{
  const RoomView view = renderView(2, 10);
  int before = -1;
  for (const double noise : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const LabelDistributions distributions = syntheticDistributions(view, 1, noise);
    ASSERT_EQ(distributions.classes(), room_classes);
    EXPECT_GT(distributions.matrix().minCoeff(), 0.0f);
    const Eigen::RowVectorXf sums = distributions.matrix().colwise().sum();
    EXPECT_NEAR(sums.minCoeff(), 1.0f, 1e-5f);
    EXPECT_NEAR(sums.maxCoeff(), 1.0f, 1e-5f);
    const int wrong = countMistakes(view, noise);
    EXPECT_GT(wrong, before) << "noise " << noise;
    before = wrong;
  }
  EXPECT_EQ(countMistakes(view, 0.0), 0);
}

TEST(SyntheticRoom, DefaultLabelsAreAsHardAsThoseOfKitchens)
{
  int wrong = 0, pixels = 0;
  const SyntheticRoom room(1);
  const RoomRenderer renderer(room, kWidth, kHeight);
  for (int frame = 0; frame < room.frames(); frame += 5) {
    wrong += countMistakes(renderer.render(frame), kSyntheticLabelNoise);
    pixels += kWidth * kHeight;
  }
  EXPECT_GT(wrong, 0.15 * pixels);
  EXPECT_LT(wrong, 0.35 * pixels);
}

TEST(RoomWriter, WhatItWritesReadsBack)
{
  const TemporaryFolder temporary;
  const std::string folder = temporary.path();
  const SyntheticRoom room(8, 3);
  const RoomRenderer renderer(room, kWidth, kHeight);
  const RoomWriter writer(folder);
  writer.writeSequence(room, renderer.camera());
  LabelDistributions distributions;
  RoomView view;
  for (int frame = 0; frame < 3; ++frame) {
    view = renderer.render(frame);
    distributions = syntheticDistributions(view, 8);
    writer.writeFrame(view, measuredDepth(view, 8, 0.0), distributions);
  }
  const RgbdSequence sequence(folder, readPinholeCamera(folder + "/camera.yaml"));
  ASSERT_EQ(sequence.size(), 3u);
  EXPECT_TRUE(sequence.doubts().empty());
  EXPECT_NEAR(sequence.camera().fx, renderer.camera().fx, 1e-6);
  EXPECT_NEAR(sequence.camera().cx, renderer.camera().cx, 1e-6);
  const RgbdFrame frame = sequence.frame(2);
  EXPECT_TRUE(isSameImage(frame.image, view.colour));
  for (int v = 0; v < kHeight; v += 7)
    for (int u = 0; u < kWidth; u += 7)
      EXPECT_NEAR(frame.cloud->at(u, v).z, view.depth.at<float>(v, u), 0.0006f);
  EXPECT_TRUE(readDistributions(folder + "/labels/000002.bin", kWidth, kHeight,
                                room_classes, 1.0f)
                  .matrix()
                  .isApprox(distributions.matrix(), 1e-6f));
  const Trajectory poses = readKittiTrajectory(folder + "/poses.txt");
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_TRUE(poses[2].isApprox(room.pose(2), 1e-8));
}
