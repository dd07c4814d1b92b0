// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/stereo_rig.h>

#include <Eigen/Geometry>

#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include <string>

namespace pcl_semantic {

/** \brief A camera with few, non-square pixels and a decentred principal point. */
inline StereoCamera
smallCamera()
{
  return {60.0, 50.0, 40.2, 25.3, 0.5, 80, 50};
}

/** \brief A rotation by an angle around each axis, x first [degrees]. */
inline Eigen::Matrix3d
rotationBy(double x, double y, double z)
{
  constexpr double degree = EIGEN_PI / 180.0;
  return (Eigen::AngleAxisd(z * degree, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(y * degree, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x * degree, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/** \brief A rig with the camera positions of a rectified pair, but rotated: \a A1 and
 * \a A2 rotate directions from the pair's frame to the left and the right camera. */
inline StereoRig
turnedRig(const StereoCamera& pair, const Eigen::Matrix3d& A1,
          const Eigen::Matrix3d& A2)
{
  StereoRig rig;
  rig.width = pair.width;
  rig.height = pair.height;
  rig.K1 << 1.15 * pair.fx, 0, pair.cx + 1.5, 0, 1.16 * pair.fy, pair.cy - 0.7, 0, 0, 1;
  rig.K2 << 1.17 * pair.fx, 0, pair.cx - 2.0, 0, 1.16 * pair.fy, pair.cy + 0.9, 0, 0, 1;
  rig.D1 = {-0.08, 0.02, 0.001, -0.0005, 0.003};
  rig.D2 = {-0.09, 0.03, -0.0008, 0.0004, -0.002};
  rig.R = A2 * A1.transpose();
  rig.T = -A2 * Eigen::Vector3d(pair.baseline, 0, 0);
  return rig;
}

/** \brief A rig of 640 x 480 pixels, rotated by some degrees. */
inline StereoRig
exampleRig()
{
  const StereoCamera pair{450.0, 450.0, 320.0, 238.0, 0.12, 640, 480};
  return turnedRig(pair, rotationBy(1.0, -1.5, 0.7), rotationBy(-0.8, 1.2, -0.5));
}

/** \brief Writes a rig in the format of OpenCV programs. */
inline void
writeRig(const std::string& path, const StereoRig& rig)
{
  cv::FileStorage file(path, cv::FileStorage::WRITE);
  file << "image_width" << rig.width << "image_height" << rig.height;
  cv::Mat matrix;
  for (const auto& [name, value] :
       {std::pair("K1", &rig.K1), std::pair("K2", &rig.K2), std::pair("R", &rig.R)}) {
    cv::eigen2cv(*value, matrix);
    file << name << matrix;
  }
  cv::eigen2cv(rig.T, matrix);
  file << "T" << matrix << "D1" << cv::Mat(rig.D1) << "D2" << cv::Mat(rig.D2).t();
}

} // namespace pcl_semantic
