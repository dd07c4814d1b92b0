// SPDX-License-Identifier: BSD-3-Clause
#include "support/same_image.h"
#include "synthesize/labels.h"
#include "synthesize/renderer.h"
#include "synthesize/sequence.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <array>
#include <random>

using namespace pcl_semantic;

namespace {

constexpr int kWidth = 310;
constexpr int kHeight = 94;

double
depthAt(const SyntheticView& view, int u, int v)
{
  const double disparity = view.disparity.at<float>(v, u);
  return disparity > 0.0 ? view.camera.depth(disparity) : 0.0;
}

Eigen::Vector3d
worldPoint(const SyntheticView& view, int u, int v)
{
  return view.T_world_camera * view.camera.unproject(u, v, depthAt(view, u, v));
}

// A camera that looks to the left, half a metre behind the front one.
Eigen::Isometry3d
leftward()
{
  Eigen::Isometry3d T_rig_camera = Eigen::Isometry3d::Identity();
  T_rig_camera.translation().z() = -0.5;
  T_rig_camera.rotate(Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitY()));
  return T_rig_camera;
}

} // namespace

TEST(SyntheticScene, FirstCameraIsTheOriginAndTheCarDrivesOn)
{
  const SyntheticScene scene(3);
  EXPECT_TRUE(scene.kittiPose(0).isApprox(Eigen::Isometry3d::Identity(), 1e-15));
  EXPECT_EQ(scene.pose(0).translation().norm(), 0.0);
  EXPECT_TRUE((scene.pose(0).linear() * Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE((scene.pose(0).linear() * Eigen::Vector3d::UnitX())
                  .isApprox(-Eigen::Vector3d::UnitY()));
  double turned = 0.0;
  for (int frame = 0; frame + 1 < scene.frames(); ++frame) {
    const Eigen::Isometry3d step = scene.pose(frame).inverse() * scene.pose(frame + 1);
    EXPECT_NEAR(step.translation().norm(), SyntheticScene::metres_per_frame, 0.05);
    EXPECT_NEAR(step.linear().determinant(), 1.0, 1e-12);
    turned += Eigen::AngleAxisd(step.linear()).angle();
  }
  EXPECT_GT(turned, 0.4) << "there has to be a turn in the road";
}

TEST(SyntheticScene, RefusesWhatItCannotRender)
{
  EXPECT_THROW(SyntheticScene(1, 0), InvalidParameterException);
  EXPECT_THROW(SyntheticScene(1, 100001), InvalidParameterException);
  const SyntheticScene scene(1, 2);
  EXPECT_THROW(scene.pose(-1), InvalidParameterException);
  EXPECT_THROW(scene.pose(2), InvalidParameterException);
  for (const cv::Size size :
       {cv::Size(63, 32), cv::Size(64, 31), cv::Size(4097, 32), cv::Size(64, 4097)})
    EXPECT_THROW(SyntheticRenderer(scene, size.width, size.height),
                 InvalidParameterException);
  EXPECT_EQ(SyntheticRenderer(scene, 64, 32).render(1).left.size(), cv::Size(64, 32));
}

TEST(SyntheticScene, ALongerStreetBeginsAlike)
{
  const SyntheticScene one(6, 10);
  const SyntheticScene other(6, 150);
  std::mt19937 random(1);
  for (int frame = 0; frame < 10; ++frame) {
    ASSERT_EQ(one.pose(frame).matrix(), other.pose(frame).matrix());
    const Eigen::Isometry3d pose = one.pose(frame);
    for (int i = 0; i < 200; ++i) {
      const double u = random() % 2000 / 1000.0 - 1.0;
      const double v = random() % 600 / 1000.0 - 0.3;
      const Eigen::Vector3d direction = pose.linear() * Eigen::Vector3d(u, v, 1.0);
      const SyntheticHit hit = one.intersect(pose.translation(), direction);
      const SyntheticHit again = other.intersect(pose.translation(), direction);
      if (hit.distance < 60.0) {
        ASSERT_EQ(hit.point, again.point);
      }
    }
  }
}

// A point of the left image must agree with a ray from the right camera, which hits the
// point or a nearer surface, never a farther one.
TEST(SyntheticRenderer, DisparityAgreesWithTheRightCamera)
{
  const SyntheticScene scene(1);
  const SyntheticRenderer renderer(scene, kWidth, kHeight);
  int points = 0, met = 0, behind = 0;
  for (const int frame : {0, 17, 39}) {
    const SyntheticView view = renderer.render(frame);
    const Eigen::Vector3d right =
        view.T_world_camera * Eigen::Vector3d(view.camera.baseline, 0.0, 0.0);
    for (int v = 0; v < kHeight; v += 3)
      for (int u = 0; u < kWidth; u += 3) {
        ASSERT_EQ(depthAt(view, u, v) == 0.0,
                  view.labels.at<Label>(v, u) == synthetic_sky);
        if (depthAt(view, u, v) == 0.0)
          continue;
        ++points;
        const Eigen::Vector3d point = worldPoint(view, u, v);
        const SyntheticHit hit = scene.intersect(right, point - right);
        met += std::abs(hit.distance - 1.0) < 2e-3;
        behind += hit.distance > 1.0 + 2e-3;
      }
  }
  EXPECT_GT(points, 5000);
  EXPECT_GT(met, 0.88 * points);
  EXPECT_LT(behind, 0.01 * points);
}

TEST(SyntheticRenderer, RightImageIsTheLeftOneMovedByTheDisparity)
{
  const SyntheticScene scene(2);
  const SyntheticView view = SyntheticRenderer(scene, kWidth, kHeight).render(8);
  const auto meanDifference = [&view](double extra) {
    double sum = 0.0;
    int count = 0;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 60; u < kWidth - 10; ++u) {
        const double disparity = view.disparity.at<float>(v, u);
        const int column = static_cast<int>(std::lround(u - disparity - extra));
        if (disparity == 0.0 || column < 0 || column >= kWidth)
          continue;
        sum += cv::norm(view.left.at<cv::Vec3b>(v, u) -
                            view.right.at<cv::Vec3b>(v, column),
                        cv::NORM_L1);
        ++count;
      }
    return sum / count;
  };
  EXPECT_LT(meanDifference(0.0), 0.6 * meanDifference(4.0));
  EXPECT_LT(meanDifference(0.0), 0.6 * meanDifference(-4.0));
}

TEST(SyntheticRenderer, ConsecutiveFramesSeeTheSameSurfaces)
{
  const SyntheticScene scene(1);
  const SyntheticRenderer renderer(scene, kWidth, kHeight);
  for (const int frame : {0, 20}) {
    const SyntheticView view = renderer.render(frame);
    const SyntheticView next = renderer.render(frame + 1);
    int points = 0, same = 0, behind = 0;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        if (depthAt(view, u, v) == 0.0)
          continue;
        const Eigen::Vector3d p =
            next.T_world_camera.inverse() * worldPoint(view, u, v);
        const Eigen::Vector2d pixel = next.camera.project(p);
        const int column = static_cast<int>(std::lround(pixel.x()));
        const int row = static_cast<int>(std::lround(pixel.y()));
        if (p.z() < 1.0 || column < 0 || row < 0 || column >= kWidth || row >= kHeight)
          continue;
        ++points;
        const double depth = depthAt(next, column, row);
        same += std::abs(depth - p.z()) < 0.04 * p.z();
        behind += depth == 0.0 || depth > 1.1 * p.z();
      }
    EXPECT_GT(points, 10000);
    EXPECT_GT(same, 0.85 * points) << "frame " << frame;
    EXPECT_LT(behind, 0.05 * points) << "frame " << frame;
  }
}

TEST(SyntheticRenderer, GroundLiesWhereItsLabelSays)
{
  const SyntheticScene scene(4);
  const SyntheticView view = SyntheticRenderer(scene, kWidth, kHeight).render(12);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      const double height = worldPoint(view, u, v).z() + SyntheticScene::camera_height;
      const double slack = 1e-6 * depthAt(view, u, v) + 1e-4;
      if (view.labels.at<Label>(v, u) == synthetic_road) {
        ASSERT_NEAR(height, 0.0, slack);
      }
      if (view.labels.at<Label>(v, u) == synthetic_sidewalk) {
        ASSERT_NEAR(height, 0.07, 0.07 + slack); // the kerb's face or its top
      }
    }
}

TEST(SyntheticRenderer, ShowsAllClassesOfAStreet)
{
  for (const std::uint32_t seed : {1u, 2u, 3u, 77u}) {
    const SyntheticScene scene(seed);
    const SyntheticRenderer renderer(scene, 2 * 124, 2 * 37);
    std::array<int, synthetic_classes + 1> count{};
    for (int frame = 0; frame < scene.frames(); frame += 8) {
      const SyntheticView view = renderer.render(frame);
      for (std::size_t i = 0; i < view.labels.total(); ++i)
        ++count.at(view.labels.ptr<Label>()[i]);
    }
    EXPECT_EQ(count[kUnlabelled], 0);
    for (int label = 1; label <= synthetic_classes; ++label)
      if (label != synthetic_pedestrian && label != synthetic_cyclist) {
        EXPECT_GT(count[label], 100) << "seed " << seed << " label " << label;
      }
  }
}

TEST(SyntheticRenderer, IntensitiesVaryWhereStereoNeedsThem)
{
  const SyntheticScene scene(1);
  const SyntheticView view = SyntheticRenderer(scene, kWidth, kHeight).render(0);
  int windows = 0, textured = 0;
  for (int v = 2; v + 2 < kHeight; v += 2)
    for (int u = 2; u + 2 < kWidth; u += 2) {
      if (view.labels.at<Label>(v, u) == synthetic_sky)
        continue;
      cv::Scalar mean, deviation;
      cv::meanStdDev(view.left(cv::Rect(u - 2, v - 2, 5, 5)), mean, deviation);
      ++windows;
      textured += deviation[1] > 2.0; // the sensor's noise alone is 0.9
    }
  EXPECT_GT(textured, 0.85 * windows);
}

TEST(SyntheticSequence, IsWhatTheRendererSees)
{
  const SyntheticSequence street(3, 124, 38, Eigen::Isometry3d::Identity(), 5);
  const SyntheticScene scene(5, 3);
  const SyntheticRenderer renderer(scene, 124, 38);
  ASSERT_EQ(street.size(), 3u);
  EXPECT_EQ(street.camera().width, 124);
  EXPECT_TRUE(street.posesPath().empty());
  for (const int i : {0, 2}) {
    const SyntheticView view = renderer.render(i);
    const StereoFrame frame = street.frame(std::size_t(i));
    EXPECT_EQ(frame.number, i);
    EXPECT_DOUBLE_EQ(frame.timestamp, 0.1 * i);
    EXPECT_TRUE(isSameImage(frame.left, view.left));
    EXPECT_TRUE(isSameImage(frame.right, view.right));
    EXPECT_TRUE(street.pose(std::size_t(i)).isApprox(renderer.pose(i)));
    EXPECT_TRUE(street.pose(std::size_t(i))
                    .isApprox(scene.pose(i) * street.T_camera0_camera()));
    EXPECT_EQ(street.labels(std::size_t(i)).matrix(),
              syntheticDistributions(view, 5).matrix());
  }
  EXPECT_THROW(street.frame(3), InvalidParameterException);
}

TEST(SyntheticSequence, ACameraMountedElsewhereSeesTheSameStreet)
{
  const SyntheticSequence street(2, 124, 38, leftward(), 5);
  const SyntheticScene scene(5, 2);
  const SyntheticView view = street.view(1);
  EXPECT_TRUE(view.T_world_camera.isApprox(street.pose(1)));
  // It looks to the left: along y of the first frame, as the road begins straight.
  EXPECT_GT((street.pose(0).linear() * Eigen::Vector3d::UnitZ()).y(), 0.95);
  EXPECT_NEAR(street.pose(0).translation().x(), -0.5, 0.05);
  int seen = 0;
  for (int v = 0; v < 38; v += 3)
    for (int u = 0; u < 124; u += 3) {
      const SyntheticHit hit = scene.intersect(view.T_world_camera.translation(),
                                               view.T_world_camera.linear() *
                                                   view.camera.unproject(u, v, 1.0));
      ASSERT_EQ(view.labels.at<Label>(v, u), hit.label);
      if (hit.label == synthetic_sky)
        continue;
      ++seen;
      ASSERT_NEAR(view.camera.depth(view.disparity.at<float>(v, u)), hit.distance,
                  1e-4 * hit.distance);
    }
  EXPECT_GT(seen, 100);
}
