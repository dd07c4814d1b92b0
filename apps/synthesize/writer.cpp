// SPDX-License-Identifier: BSD-3-Clause
#include "writer.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>

#include <opencv2/core.hpp>

#include <array>
#include <cstdio>
#include <vector>

namespace pcl_semantic {

namespace {

/** \brief A line of calib.txt: a name and a 3 x 4 matrix, row by row. */
std::string
calibrationLine(const std::string& name, const std::array<double, 12>& matrix)
{
  std::string line = name + ":";
  for (const double value : matrix) {
    char text[32];
    std::snprintf(text, sizeof(text), " %.12e", value);
    line += text;
  }
  return line + "\n";
}

/** \brief Projection from camera 0 to the image of a camera at x [m] in its frame. */
std::array<double, 12>
projection(const StereoCamera& camera, double x)
{
  return {camera.fx, 0.0,       camera.cx, 0.0 - camera.fx * x,
          0.0,       camera.fy, camera.cy, 0.0,
          0.0,       0.0,       1.0,       0.0};
}

std::string
calibration(const StereoCamera& camera)
{
  const double x2 = SyntheticRenderer::camera_2_offset;
  // A laser scanner on the roof: x forward, y left, z up.
  const std::array<double, 12> laser{0, -1, 0, 0.0, 0, 0, -1, -0.08, 1, 0, 0, -0.27};
  return calibrationLine("P0", projection(camera, 0.0)) +
         calibrationLine("P1", projection(camera, camera.baseline)) +
         calibrationLine("P2", projection(camera, x2)) +
         calibrationLine("P3", projection(camera, x2 + camera.baseline)) +
         calibrationLine("Tr", laser);
}

// Kalibr's file of a fisheye pair.
std::string
camchain(const StereoCamera& camera)
{
  char lens[512];
  std::snprintf(lens, sizeof(lens),
                "  camera_model: pinhole\n  distortion_model: equidistant\n"
                "  distortion_coeffs: [0, 0, 0, 0]\n"
                "  intrinsics: [%.12g, %.12g, %.12g, %.12g]\n"
                "  resolution: [%d, %d]\n",
                camera.fx, camera.fy, camera.cx, camera.cy, camera.width,
                camera.height);
  char pose[256];
  std::snprintf(pose, sizeof(pose),
                "  T_cn_cnm1:\n  - [1, 0, 0, %.12g]\n  - [0, 1, 0, 0]\n"
                "  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n",
                -camera.baseline);
  return std::string("cam0:\n") + lens + "cam1:\n" + lens + pose;
}

} // namespace

SyntheticWriter::SyntheticWriter(std::string folder, synthetic::Lens lens)
    : folder_(std::move(folder)), lens_(lens)
{
  makeOutputFolder(folder_);
  std::vector<const char*> names = {"image_2", "image_3"};
  if (lens == synthetic::Lens::pinhole)
    names.insert(names.end(), {"disparity", "gt", "labels"});
  for (const char* name : names)
    makeOutputFolder(folder_ + "/" + name);
}

void
SyntheticWriter::writeSequence(const SyntheticScene& scene,
                               const StereoCamera& camera) const
{
  std::string times;
  const bool is_rig = lens_ != synthetic::Lens::pinhole; // its camera 0 is the left one
  const Eigen::Translation3d offset(is_rig ? SyntheticRenderer::camera_2_offset : 0.0,
                                    0.0, 0.0);
  Trajectory poses;
  for (int frame = 0; frame < scene.frames(); ++frame) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6e\n",
                  frame * SyntheticScene::seconds_per_frame);
    times += text;
    poses.push_back(offset.inverse() * scene.kittiPose(frame) * offset);
  }
  if (is_rig)
    writeTextFile(folder_ + "/camchain.yaml", camchain(camera));
  else
    writeTextFile(folder_ + "/calib.txt", calibration(camera));
  writeTextFile(folder_ + "/times.txt", times);
  writeKittiTrajectory(folder_ + "/poses.txt", poses);
}

void
SyntheticWriter::writeImages(const SyntheticView& view) const
{
  const std::string png = "/" + frameFileName(view.frame, ".png");
  writePng(folder_ + "/image_2" + png, view.left);
  writePng(folder_ + "/image_3" + png, view.right);
}

void
SyntheticWriter::writeFrame(const SyntheticView& view,
                            const LabelDistributions& distributions) const
{
  const std::string png = "/" + frameFileName(view.frame, ".png");
  cv::Mat disparity;
  view.disparity.convertTo(disparity, CV_16UC1, 256.0);
  disparity.setTo(0, view.disparity > 255.99); // exceeds the format: none
  writeImages(view);
  writePng(folder_ + "/disparity" + png, disparity);
  writePng(folder_ + "/gt" + png, view.labels);
  writeDistributions(folder_ + "/labels/" + frameFileName(view.frame, ".bin"),
                     distributions);
}

} // namespace pcl_semantic
