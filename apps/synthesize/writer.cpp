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

} // namespace

SyntheticWriter::SyntheticWriter(std::string folder) : folder_(std::move(folder))
{
  makeOutputFolder(folder_);
  for (const char* name : {"image_2", "image_3", "disparity", "gt", "labels"})
    makeOutputFolder(folder_ + "/" + name);
}

void
SyntheticWriter::writeSequence(const SyntheticScene& scene,
                               const StereoCamera& camera) const
{
  std::string times;
  Trajectory poses;
  for (int frame = 0; frame < scene.frames(); ++frame) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6e\n",
                  frame * SyntheticScene::seconds_per_frame);
    times += text;
    poses.push_back(scene.kittiPose(frame));
  }
  writeTextFile(folder_ + "/calib.txt", calibration(camera));
  writeTextFile(folder_ + "/times.txt", times);
  writeKittiTrajectory(folder_ + "/poses.txt", poses);
}

void
SyntheticWriter::writeFrame(const SyntheticView& view,
                            const LabelDistributions& distributions) const
{
  const std::string png = "/" + frameFileName(view.frame, ".png");
  cv::Mat disparity;
  view.disparity.convertTo(disparity, CV_16UC1, 256.0);
  disparity.setTo(0, view.disparity > 255.99); // exceeds the format: none
  writePng(folder_ + "/image_2" + png, view.left);
  writePng(folder_ + "/image_3" + png, view.right);
  writePng(folder_ + "/disparity" + png, disparity);
  writePng(folder_ + "/gt" + png, view.labels);
  writeDistributions(folder_ + "/labels/" + frameFileName(view.frame, ".bin"),
                     distributions);
}

} // namespace pcl_semantic
