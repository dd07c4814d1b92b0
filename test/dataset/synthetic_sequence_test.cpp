// SPDX-License-Identifier: BSD-3-Clause
#include "support/same_image.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/synthetic_labels.h>
#include <pcl_semantic/dataset/synthetic_sequence.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

using namespace pcl_semantic;

namespace {

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
