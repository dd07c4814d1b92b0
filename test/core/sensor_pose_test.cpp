// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/sensor_pose.h>

#include <gtest/gtest.h>

#include <pcl/point_types.h>

#include <cmath>
#include <limits>

namespace pcl_semantic {

TEST(SensorPose, NeedsAQuaternion)
{
  pcl::PointCloud<pcl::PointXYZ> cloud;
  EXPECT_TRUE(sensorPose(cloud).isApprox(Eigen::Isometry3d::Identity()));
  for (const float w : {0.0f, std::nanf("")}) {
    cloud.sensor_orientation_ = Eigen::Quaternionf(w, 0, 0, 0);
    EXPECT_THROW(sensorPose(cloud), BadInputException);
  }
}

TEST(RequireRigid, TakesRotationsAndTranslationsAlone)
{
  Eigen::Isometry3d pose(Eigen::Translation3d(10, 20, 1) *
                         Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  EXPECT_NO_THROW(requireRigid(pose, "p"));
  pose(0, 0) += 2e-4; // a text of few digits
  EXPECT_NO_THROW(requireRigid(pose, "p"));
  pose.matrix().row(3) += Eigen::RowVector4d(1e-16, -1e-9, 0, 1e-9); // of an inverse
  EXPECT_NO_THROW(requireRigid(pose, "p"));

  const auto refuses = [&](const std::string& says, const Eigen::Matrix4d& matrix) {
    return throws<BadInputException>(
        says, [&] { requireRigid(Eigen::Isometry3d(matrix), "the pose of frame 3"); });
  };
  EXPECT_TRUE(
      refuses("the pose of frame 3 has the last row", pose.matrix().transpose()));
  Eigen::Matrix4d matrix = pose.matrix();
  for (const double last : {2.0, 1.00001}) {
    matrix(3, 3) = last;
    EXPECT_TRUE(refuses("expected 0 0 0 1", matrix));
  }
  matrix = pose.matrix();
  matrix.topLeftCorner<3, 3>() *= 1.1;
  EXPECT_TRUE(refuses("is not a rotation and translation", matrix));
  matrix = Eigen::Vector4d(1, 1, -1, 1).asDiagonal(); // a mirror
  EXPECT_TRUE(refuses("is not a rotation and translation", matrix));
  matrix(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses("is not finite", matrix));
}

} // namespace pcl_semantic
