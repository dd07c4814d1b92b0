// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/sensor_pose.h>

#include "core/fail.h"

namespace pcl_semantic {

void
requireRigid(const Eigen::Isometry3d& pose, const std::string& name)
{
  const Eigen::Matrix4d& matrix = pose.matrix();
  if (!matrix.allFinite())
    badInput(name, " is not finite");
  constexpr double rounding = 1e-6; // rounding error of an inverse or of text
  if (!((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() <=
        rounding))
    badInput(name, " has the last row ", matrix.row(3),
             ", expected 0 0 0 1 (is the matrix transposed?)");
  const Eigen::Matrix3d R = pose.linear();
  constexpr double tolerance = 1e-3;
  if (!(R.transpose() * R).isIdentity(tolerance) || R.determinant() < 0.0)
    badInput(name, " is not a rotation and translation");
}

} // namespace pcl_semantic
