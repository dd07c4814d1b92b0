// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <gtest/gtest.h>

#include <limits>

using namespace pcl_semantic;

namespace {

const StereoCamera some_camera{707.0, 650.0, 601.9, 183.1, 0.5379, 1241, 376};

} // namespace

TEST(StereoCamera, DepthOfADisparity)
{
  const StereoCamera& camera = some_camera;
  EXPECT_DOUBLE_EQ(camera.depth(38.03), 707.0 * 0.5379 / 38.03);
  EXPECT_GT(camera.depth(1.0), camera.depth(2.0));
}

TEST(StereoCamera, AxesAreRightDownForward)
{
  const StereoCamera& camera = some_camera;
  EXPECT_TRUE(camera.unproject(camera.cx, camera.cy, 7.0)
                  .isApprox(Eigen::Vector3d(0.0, 0.0, 7.0)));
  // One focal length right of the principal point lies as far right as forward.
  EXPECT_TRUE(camera.unproject(camera.cx + 707.0, camera.cy, 7.0)
                  .isApprox(Eigen::Vector3d(7.0, 0.0, 7.0)));
  EXPECT_TRUE(camera.unproject(camera.cx, camera.cy + 650.0, 7.0)
                  .isApprox(Eigen::Vector3d(0.0, 7.0, 7.0)));
}

TEST(StereoCamera, ProjectUndoesUnproject)
{
  const StereoCamera& camera = some_camera;
  for (double u = -10.0; u < 1300.0; u += 130.7)
    for (double v = -10.0; v < 400.0; v += 41.3)
      for (const double depth : {0.3, 5.0, 80.0})
        EXPECT_LT(
            (camera.project(camera.unproject(u, v, depth)) - Eigen::Vector2d(u, v))
                .norm(),
            1e-9);
}

TEST(StereoCamera, ValidateNamesWhatIsWrong)
{
  EXPECT_NO_THROW(some_camera.validate());
  StereoCamera camera = some_camera;
  camera.baseline = -0.54;
  expectBadParameter("-0.54", [&] { camera.validate(); });
  camera = some_camera;
  camera.fy = 0.0;
  expectBadParameter("focal", [&] { camera.validate(); });
  for (double StereoCamera::*const member :
       {&StereoCamera::fx, &StereoCamera::fy, &StereoCamera::cx, &StereoCamera::cy,
        &StereoCamera::baseline})
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
      camera = some_camera;
      camera.*member = bad;
      thrownMessage<InvalidParameterException>([&] { camera.validate(); });
    }
}
