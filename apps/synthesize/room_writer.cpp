// SPDX-License-Identifier: BSD-3-Clause
#include "room_writer.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>

#include <cstdio>
#include <utility>
#include <vector>

namespace pcl_semantic {

RoomWriter::RoomWriter(std::string folder, synthetic::Lens lens)
    : folder_(std::move(folder)), lens_(lens)
{
  makeOutputFolder(folder_);
  std::vector<const char*> names = {"rgb", "depth"};
  if (lens == synthetic::Lens::pinhole)
    names.insert(names.end(), {"gt", "labels"});
  for (const char* name : names)
    makeOutputFolder(folder_ + "/" + name);
}

void
RoomWriter::writeSequence(const SyntheticRoom& room, const StereoCamera& camera) const
{
  Trajectory poses;
  for (int frame = 0; frame < room.frames(); ++frame)
    poses.push_back(room.pose(frame));
  char text[512];
  std::snprintf(
      text, sizeof(text),
      "image_width: %d\nimage_height: %d\ncamera_name: synthetic_room\n"
      "camera_matrix: {rows: 3, cols: 3, data: [%.9g, 0, %.9g, 0, %.9g, %.9g, "
      "0, 0, 1]}\n%s",
      camera.width, camera.height, camera.fx, camera.cx, camera.fy, camera.cy,
      lens_ == synthetic::Lens::pinhole
          ? "distortion_model: plumb_bob\n"
            "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n"
          : "distortion_model: equidistant\n"
            "distortion_coefficients: {rows: 1, cols: 4, data: [0, 0, 0, 0]}\n");
  writeTextFile(folder_ + "/camera.yaml", text);
  writeKittiTrajectory(folder_ + "/poses.txt", poses);
}

void
RoomWriter::writeImages(const RoomView& view, const cv::Mat& depth) const
{
  const std::string png = "/" + frameFileName(view.frame, ".png");
  writePng(folder_ + "/rgb" + png, view.colour);
  writePng(folder_ + "/depth" + png, depth);
}

void
RoomWriter::writeFrame(const RoomView& view, const cv::Mat& depth,
                       const LabelDistributions& distributions) const
{
  const std::string png = "/" + frameFileName(view.frame, ".png");
  writeImages(view, depth);
  writePng(folder_ + "/gt" + png, view.labels);
  writeDistributions(folder_ + "/labels/" + frameFileName(view.frame, ".bin"),
                     distributions);
}

} // namespace pcl_semantic
