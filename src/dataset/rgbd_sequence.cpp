// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/rgbd_sequence.h>

#include "core/fail.h"
#include "core/split.h"
#include "files/file_pattern.h"

#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr double kMaxDifference = 0.02; // of the times of colour and depth [s]

struct TimedFile {
  double time = 0.0;
  std::string word, path; // the time as it stands there
};

std::vector<TimedFile>
readList(const std::string& folder, const std::string& name)
{
  const std::string path = folder + "/" + name;
  std::vector<TimedFile> files;
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty() || line.text[0] == '#')
      continue;
    const std::vector<std::string_view> words = wordsOf(line.text);
    if (words.size() != 2)
      fail<BadInputException>(atLine(path, line.number),
                              ": expected a time and a file");
    TimedFile file;
    file.word = words[0];
    file.time = parseNumber(file.word, atLine(path, line.number));
    if (!std::isfinite(file.time) || (!files.empty() && file.time <= files.back().time))
      fail<BadInputException>(atLine(path, line.number), ": times have to rise");
    file.path = folder + "/" + std::string(words[1]);
    files.push_back(file);
  }
  if (files.empty())
    fail<BadInputException>(path, ": names no image");
  return files;
}

} // namespace

RgbdSequence::RgbdSequence(const std::string& folder, const PinholeCamera& camera,
                           double depth_scale)
    : camera_(camera), depth_scale_(depth_scale)
{
  camera_.validate();
  if (!(depth_scale >= 0.0 && std::isfinite(depth_scale)))
    fail<InvalidParameterException>("depth scale is ", depth_scale,
                                    ", expected 0 or more");
  const bool is_tum = fs::exists(folder + "/rgb.txt");
  if (is_tum)
    readTumLists(folder);
  else
    findFolders(folder);
  if (depth_scale_ == 0.0)
    depth_scale_ = is_tum ? 5000.0 : 1000.0;
}

void
RgbdSequence::readTumLists(const std::string& folder)
{
  const std::vector<TimedFile> depths = readList(folder, "depth.txt");
  for (const TimedFile& colour : readList(folder, "rgb.txt")) {
    const auto nearest = std::min_element(
        depths.begin(), depths.end(), [&](const TimedFile& a, const TimedFile& b) {
          return std::abs(a.time - colour.time) < std::abs(b.time - colour.time);
        });
    if (std::abs(nearest->time - colour.time) <= kMaxDifference)
      frames_.push_back({colour.word, colour.path, nearest->path, colour.time});
  }
  if (frames_.empty())
    fail<BadInputException>(folder, "/depth.txt: no time is within ", kMaxDifference,
                            " s of one in rgb.txt");
}

void
RgbdSequence::findFolders(const std::string& folder)
{
  for (const char* const name : {"rgb", "depth"})
    if (!fs::is_directory(folder + "/" + name))
      fail<BadInputException>(folder, ": has neither rgb.txt nor a folder '", name,
                              "': no RGB-D sequence");
  for (const std::string& colour : findFiles(folder + "/rgb", imageExtensions())) {
    const std::string name = fs::path(colour).stem().string();
    const std::string depth = folder + "/depth/" + name + ".png";
    if (!fs::exists(depth))
      fail<BadInputException>(depth, ": is missing, the depth image of ", colour);
    frames_.push_back({name, colour, depth, 0.1 * double(frames_.size())});
  }
}

StereoCamera
RgbdSequence::camera() const
{
  const cv::Mat first = readImage(frames_.front().colour);
  return {camera_.fx, camera_.fy, camera_.cx, camera_.cy, 1.0, first.cols, first.rows};
}

CloudFrame
RgbdSequence::frame(std::size_t i, double max_depth) const
{
  const Files& files = frames_.at(i);
  const cv::Mat image = readImage(files.colour);
  const cv::Mat depths = readPng(files.depth, ImageKind::disparity);
  if (image.size() != depths.size())
    fail<BadInputException>(files.depth, ": has ", depths.cols, " x ", depths.rows,
                            " pixels, expected those of ", files.colour, ", ",
                            image.cols, " x ", image.rows);
  CloudFrame frame{{int(i), files.time}, {}, {}, true};
  frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(
      std::uint32_t(image.cols), std::uint32_t(image.rows));
  frame.cloud->is_dense = false;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      pcl::PointXYZRGB& point = (*frame.cloud)(u, v);
      const double z = double(depths.at<std::uint16_t>(v, u)) / depth_scale_;
      if (z > 0.0 && (max_depth == 0.0 || z <= max_depth))
        point.getVector3fMap() << float((u - camera_.cx) / camera_.fx * z),
            float((v - camera_.cy) / camera_.fy * z), float(z);
      else
        point.getVector3fMap().setConstant(none);
      const cv::Vec3b bgr = image.channels() == 3
                                ? image.at<cv::Vec3b>(v, u)
                                : cv::Vec3b::all(image.at<std::uint8_t>(v, u));
      point.b = bgr[0];
      point.g = bgr[1];
      point.r = bgr[2];
    }
  return frame;
}

} // namespace pcl_semantic
