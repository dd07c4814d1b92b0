// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/stereo_rigs.h"
#include "support/tiny_street.h"

#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <filesystem>
#include <string>

namespace pcl_semantic {

/** \brief Rotation of the cameras of ownCamera() relative to those of the sequence. */
inline Eigen::Matrix3d
turnOfOwnCamera(bool left)
{
  return left ? rotationBy(2.0, -3.0, 1.0) : rotationBy(1.0, -2.0, 1.5);
}

/** \brief An image of the sequence as another camera sees it from the same position.
 * \param[in] street a rectified image
 * \param[in] pair its camera
 * \param[in] rays directions in the pair's frame, one for each pixel of the result
 * \param[in] interpolation cv::INTER_... */
inline cv::Mat
seenAlong(const cv::Mat& street, const StereoCamera& pair, const cv::Mat3d& rays,
          int interpolation)
{
  cv::Mat2f map(rays.size());
  for (int y = 0; y < rays.rows; ++y)
    for (int x = 0; x < rays.cols; ++x) {
      const cv::Vec3d& ray = rays(y, x);
      const Eigen::Vector2d at = pair.project({ray[0], ray[1], ray[2]});
      map(y, x) = cv::Vec2f(float(at.x()), float(at.y()));
    }
  cv::Mat seen;
  cv::remap(street, seen, map, cv::noArray(), interpolation, cv::BORDER_REPLICATE);
  return seen;
}

/** \brief The rays of a camera's pixels in the rectified frame. */
inline cv::Mat3d
raysOf(cv::Size size, const Eigen::Matrix3d& K, const std::vector<double>& D,
       const Eigen::Matrix3d& turn)
{
  cv::Mat matrix;
  cv::eigen2cv(K, matrix);
  std::vector<cv::Point2d> pixels, points;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      pixels.emplace_back(x, y);
  cv::undistortPoints(pixels, points, matrix, D, cv::noArray(), cv::noArray(),
                      {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-10});
  cv::Mat3d rays(size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d ray =
        turn.transpose() * Eigen::Vector3d(points[i].x, points[i].y, 1.0);
    rays(int(i) / size.width, int(i) % size.width) =
        cv::Vec3d(ray.x(), ray.y(), ray.z());
  }
  return rays;
}

/** \brief Writes tinyStreet() as seen by a camera that is neither rectified nor in
 * KITTI's layout: `left/shot1.png ...`, `right/`, `stereo.yaml`, `labels/` of the
 * rectified left images, and `poses.txt` of the left camera. */
inline void
writeOwnCamera(const std::string& folder)
{
  const KittiSequence street(tinyStreet());
  const StereoCamera& pair = street.camera();
  const cv::Size size(pair.width, pair.height);
  const Eigen::Matrix3d A1 = turnOfOwnCamera(true), A2 = turnOfOwnCamera(false);
  const StereoRig rig = turnedRig(pair, A1, A2);
  for (const char* const name : {"left", "right", "labels"})
    std::filesystem::create_directories(folder + "/" + name);
  writeRig(folder + "/stereo.yaml", rig);

  const cv::Mat3d left = raysOf(size, rig.K1, rig.D1, A1);
  const cv::Mat3d right = raysOf(size, rig.K2, rig.D2, A2);
  const Rectifier rectifier(rig);
  const StereoCamera& rectified = rectifier.camera();
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K.diagonal() << rectified.fx, rectified.fy, 1.0;
  K.topRightCorner<2, 1>() << rectified.cx, rectified.cy;
  const cv::Mat3d labelled = raysOf(
      size, K, {0, 0, 0, 0}, rectifier.T_left_rectified().linear().transpose() * A1);

  Trajectory poses;
  for (const Eigen::Isometry3d& T_0_n : readKittiTrajectory(street.posesPath()))
    poses.push_back(T_0_n * street.T_camera0_camera() *
                    Eigen::Quaterniond(A1.transpose()));
  writeKittiTrajectory(folder + "/poses.txt", poses);
  for (std::size_t i = 0; i < street.size(); ++i) {
    const StereoFrame frame = street.frame(i);
    const std::string name = "/shot" + std::to_string(9 + i) + ".png";
    writePng(folder + "/left" + name,
             seenAlong(frame.left, pair, left, cv::INTER_CUBIC));
    writePng(folder + "/right" + name,
             seenAlong(frame.right, pair, right, cv::INTER_CUBIC));
    const std::string file = frameFileName(frame.number, ".png");
    const cv::Mat truth = readPng(tinyStreet() + "/gt/" + file, ImageKind::labels);
    writePng(folder + "/labels/" + file,
             seenAlong(truth, pair, labelled, cv::INTER_NEAREST));
  }
}

/** \brief Tool options for the images of \a folder. */
inline std::string
ownCamera(const std::string& folder)
{
  return " --left '" + folder + "/left/*.png' --right '" + folder +
         "/right/*.png' --calibration " + folder + "/stereo.yaml ";
}

} // namespace pcl_semantic
