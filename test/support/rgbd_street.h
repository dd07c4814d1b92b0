// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/tiny_street.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <opencv2/core.hpp>

#include <filesystem>
#include <fstream>
#include <iomanip>

namespace pcl_semantic {

/** \brief Writes an RGB-D sequence from the left images of a sequence and their ground
 * truth depth in millimetres: street/rgbd, camera.yaml, and world.txt with the camera
 * poses. */
inline void
makeRgbd(const std::string& street)
{
  const KittiSequence sequence(street);
  const StereoCamera& camera = sequence.camera();
  std::filesystem::create_directories(street + "/rgbd/depth");
  std::filesystem::create_directories(street + "/rgbd/rgb");
  Trajectory poses;
  for (const Eigen::Isometry3d& pose : readKittiTrajectory(street + "/poses.txt"))
    poses.push_back(worldFromFirstCamera() * pose * sequence.T_camera0_camera());
  writeKittiTrajectory(street + "/world.txt", poses);
  std::ofstream(street + "/camera.yaml")
      << std::setprecision(17) << "K: [" << camera.fx << ", 0, " << camera.cx << ", 0, "
      << camera.fy << ", " << camera.cy << ", 0, 0, 1]\n";
  for (const char* const name : {"000000.png", "000001.png", "000002.png"}) {
    std::filesystem::copy(street + "/image_2/" + name, street + "/rgbd/rgb/" + name);
    const cv::Mat disparity =
        readPng(street + "/disparity/" + name, ImageKind::disparity);
    cv::Mat depth(disparity.size(), CV_16UC1, cv::Scalar(0));
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u)
        if (const int d = disparity.at<std::uint16_t>(v, u))
          depth.at<std::uint16_t>(v, u) =
              cv::saturate_cast<std::uint16_t>(1000.0 * camera.depth(d / 256.0));
    writePng(street + "/rgbd/depth/" + name, depth);
  }
}

} // namespace pcl_semantic
