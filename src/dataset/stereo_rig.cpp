// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/stereo_rig.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr double kFarthest = 100.0; // [m]; more are millimetres

void
validateCamera(const Eigen::Matrix3d& K, const StereoRig& rig, const char* name)
{
  if (!K.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException, name << ": is not finite");
  const double fx = K(0, 0), fy = K(1, 1), cx = K(0, 2), cy = K(1, 2);
  if (!(fx > 0.0 && fy > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, name << ": focal lengths are " << fx
                                                        << " and " << fy
                                                        << " px, expected more than 0");
  if (K(0, 1) != 0.0 || K(1, 0) != 0.0 ||
      !K.row(2).isApprox(Eigen::RowVector3d(0, 0, 1)))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": is no camera matrix, expected fx 0 cx, 0 fy cy, "
                                "0 0 1");
  if (rig.width > 0 && !(cx > 0.0 && cx < rig.width && cy > 0.0 && cy < rig.height))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": the principal point (" << cx << ", " << cy
                             << ") is outside the images of " << rig.width << " x "
                             << rig.height << " pixels");
}

void
validateDistortion(const std::vector<double>& D, const char* name)
{
  const std::size_t n = D.size();
  if (n != 4 && n != 5 && n != 8 && n != 12 && n != 14)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        name << ": has " << n
                             << " numbers, expected 4, 5, 8, 12 or 14");
  if (!std::all_of(D.begin(), D.end(), [](double d) { return std::isfinite(d); }))
    PCL_THROW_EXCEPTION(InvalidParameterException, name << ": is not finite");
}

void
validateRotation(const Eigen::Matrix3d& R)
{
  const double deviation = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(deviation <= 1e-6) || R.determinant() < 0.0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "R: is no rotation (determinant "
                                                       << R.determinant()
                                                       << ", R R^T is off by "
                                                       << deviation << ")");
}

void
validateTranslation(const Eigen::Vector3d& T)
{
  const auto fail = [&T](const char* message) {
    PCL_THROW_EXCEPTION(InvalidParameterException, "T: is (" << T.x() << ", " << T.y()
                                                             << ", " << T.z()
                                                             << "): " << message);
  };
  if (!T.allFinite())
    fail("not finite");
  if (T.isZero(0.0))
    fail("the baseline is 0 m, expected more");
  if (T.norm() > kFarthest)
    fail("the baseline is more than 100 m; if these are millimetres, expected metres");
  if (std::abs(T.y()) >= std::abs(T.x()))
    fail("one camera is above the other, expected them side by side");
  if (std::abs(T.z()) >= std::abs(T.x()))
    fail("one camera is ahead of the other, expected them side by side");
  if (T.x() > 0.0)
    fail("the right camera is on the left, expected T.x < 0 (x_right = R x_left + T); "
         "are left and right swapped?");
}

} // namespace

void
StereoRig::validate() const
{
  if (width < 0 || height < 0 || (width == 0) != (height == 0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "image size: is " << width << " x " << height << " pixels");
  validateCamera(K1, *this, "K1");
  validateCamera(K2, *this, "K2");
  validateDistortion(D1, "D1");
  validateDistortion(D2, "D2");
  validateRotation(R);
  validateTranslation(T);
}

} // namespace pcl_semantic
