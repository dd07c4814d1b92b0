// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/rgbd_sequence.h>

#include "core/fail.h"
#include "core/split.h"
#include "files/file_pattern.h"
#include "files/is_there.h"
#include "images/grey_image.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/measured_depth.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/image_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

struct TimedFile {
  double time = 0.0;
  std::string word, path; // the time as text
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

// A scale below 1 would make one number more than a metre: 0.001 is metres per number.
void
requireScale(double scale)
{
  if (!(scale >= 0.0 && std::isfinite(scale)))
    badParameter("depth scale is ", scale, ", expected 0 or more");
  if (scale > 0.0 && scale < 1.0)
    badParameter("depth scale is ", scale,
                 ", expected the value of 1 m in the depth images: ", 1.0 / scale,
                 " if the unit is ", scale, " m");
}

// Median of the valid depths.
std::optional<double>
medianOf(const cv::Mat1w& depths)
{
  std::vector<std::uint16_t> measured;
  for (const std::uint16_t depth : depths)
    if (isMeasuredDepth(depth))
      measured.push_back(depth);
  if (measured.empty())
    return std::nullopt;
  const auto middle = measured.begin() + std::ptrdiff_t(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

// Checks the median depth: in rooms and streets it is within these limits.
std::string
doubtOfScale(double median, double scale)
{
  constexpr double nearest = 0.05, farthest = 100.0; // [m]
  const double depth = median / scale;
  if (depth >= nearest && depth <= farthest)
    return {};
  TextStream text;
  text << "half of its depths are " << (depth < nearest ? "less" : "more") << " than "
       << depth << " m with depth scale " << scale;
  const auto isLikely = [&](double other) {
    return median / other >= 0.3 && median / other <= 50.0;
  };
  for (const double other : {1000.0, 5000.0, 256.0, 10000.0, 100.0})
    if (isLikely(other)) {
      text << "; " << other << " would give " << median / other << " m";
      break;
    }
  return text.str();
}

} // namespace

void
RgbdFiles::requireCamera(const std::string& calibration) const
{
  if (calibration.empty() == intrinsics.empty())
    badParameter("--rgbd needs --calibration or --intrinsics, the camera");
  if (calibration.empty())
    pinholeCameraOf("", intrinsics);
}

ConfigParameters
parametersOf(RgbdFiles& files)
{
  return {{"rgbd",
           "RGB-D sequence instead of SEQUENCE: TUM's layout, or a folder with rgb/ "
           "and depth/; needs --calibration (ROS camera_info, Kalibr) or --intrinsics",
           &files.folder},
          {"intrinsics",
           "intrinsics fx,fy,cx,cy of --rgbd instead of --calibration [px]",
           &files.intrinsics},
          {"depth_scale",
           "value of 1 m in the depth images of --rgbd; 0 = 5000 in TUM's layout, else "
           "1000",
           &files.depth_scale},
          {"depth_within",
           "maximum difference between the times of a colour image and its depth image "
           "in TUM's layout [s]",
           &files.depth_within}};
}

RgbdSequence::RgbdSequence(const RgbdFiles& files, const std::string& calibration)
    : RgbdSequence(files.folder, pinholeCameraOf(calibration, files.intrinsics),
                   files.depth_scale, files.depth_within)
{}

RgbdSequence::RgbdSequence(const std::string& folder, const PinholeCamera& camera,
                           double depth_scale, double depth_within)
    : RgbdSequence(folder, depth_scale, depth_within)
{
  camera.validate();
  doubts_.insert(doubts_.begin(), camera.doubts.begin(), camera.doubts.end());
  const std::string& first = frames_.front().colour;
  const cv::Mat image = readImage(first);
  camera_ = camera.ofImage(image.cols, image.rows, first);
}

RgbdSequence::RgbdSequence(const std::string& folder, double depth_scale,
                           double depth_within)
    : folder_(folder), depth_scale_(depth_scale)
{
  requireScale(depth_scale);
  if (!(depth_within >= 0.0 && std::isfinite(depth_within)))
    badParameter("depth_within is ", depth_within, " s, expected 0 or more");
  is_tum_ = has_times_ = isThere(folder + "/rgb.txt");
  if (is_tum_)
    readTumLists(folder, depth_within);
  else
    findFolders(folder);
  if (depth_scale_ == 0.0)
    depth_scale_ = is_tum_ ? 5000.0 : 1000.0;
}

std::map<int, std::string>
RgbdSequence::colourImages(const std::string& folder, double depth_within,
                           std::vector<std::string>* doubts)
{
  const RgbdSequence sequence(folder, 0.0, depth_within);
  std::map<int, std::string> paths;
  for (const Files& files : sequence.frames_)
    paths[files.number] = files.colour;
  if (doubts)
    doubts->insert(doubts->end(), sequence.doubts_.begin(), sequence.doubts_.end());
  return paths;
}

void
RgbdSequence::readTumLists(const std::string& folder, double depth_within)
{
  const std::vector<TimedFile> depths = readList(folder, "depth.txt");
  const std::vector<TimedFile> colours = readList(folder, "rgb.txt");
  for (std::size_t number = 0; number < colours.size(); ++number) {
    const TimedFile& colour = colours[number];
    const auto nearest = std::min_element(
        depths.begin(), depths.end(), [&](const TimedFile& a, const TimedFile& b) {
          return std::abs(a.time - colour.time) < std::abs(b.time - colour.time);
        });
    if (std::abs(nearest->time - colour.time) <= depth_within)
      frames_.push_back(
          {colour.word, colour.path, nearest->path, colour.time, int(number)});
  }
  if (frames_.empty())
    fail<BadInputException>(folder, "/depth.txt: no time is within ", depth_within,
                            " s of one in rgb.txt; --depth-within allows more");
  if (const std::size_t skipped = colours.size() - frames_.size(); skipped > 0) {
    TextStream text;
    text << folder << "/rgb.txt: " << skipped << " of its " << colours.size()
         << " images have no depth image within " << depth_within
         << " s and are skipped; --depth-within allows more";
    doubts_.push_back(text.str());
  }
}

void
RgbdSequence::findFolders(const std::string& folder)
{
  for (const char* const name : {"rgb", "depth"})
    if (!isFolder(folder + "/" + name))
      fail<BadInputException>(folder, ": has neither rgb.txt nor a folder '", name,
                              "': no RGB-D sequence");
  for (const std::string& colour : findFiles(folder + "/rgb", imageExtensions())) {
    const std::string name = fs::path(colour).stem().string();
    const std::string depth = folder + "/depth/" + name + ".png";
    if (!isThere(depth))
      fail<BadInputException>(depth, ": is missing, the depth image of ", colour);
    frames_.push_back(
        {name, colour, depth, 0.1 * double(frames_.size()), int(frames_.size())});
  }
  takeTimesFromNames();
  const std::size_t depths = findFiles(folder + "/depth", imageExtensions()).size();
  if (depths > frames_.size())
    doubts_.push_back(folder + "/depth: " + std::to_string(depths - frames_.size()) +
                      " of its images have no colour image in rgb and are ignored");
}

// "1305031102.175304": seconds with a point, in rising order.
void
RgbdSequence::takeTimesFromNames()
{
  std::vector<double> times;
  for (const Files& files : frames_) {
    if (files.name.find_first_not_of("0123456789.") != std::string::npos ||
        std::count(files.name.begin(), files.name.end(), '.') != 1)
      return;
    times.push_back(parseNumber(files.name, files.colour));
    if (times.size() > 1 && times.back() <= times[times.size() - 2])
      return;
  }
  has_times_ = true;
  for (std::size_t i = 0; i < times.size(); ++i)
    frames_[i].time = times[i];
}

std::string
RgbdSequence::posesPath() const
{
  const std::string path = folder_ + "/groundtruth.txt";
  return isThere(path) ? path : "";
}

std::vector<std::string>
RgbdSequence::doubts() const
{
  std::vector<std::string> doubts = doubts_;
  for (std::string& doubt : doubtsOf(camera_))
    doubts.push_back(std::move(doubt));
  for (const Files& files : frames_)
    if (const auto median = medianOf(readPng(files.depth, ImageKind::disparity))) {
      const std::string doubt = doubtOfScale(*median, depth_scale_);
      if (!doubt.empty())
        doubts.push_back(files.depth + ": " + doubt);
      break;
    }
  return doubts;
}

RgbdFrame
RgbdSequence::frame(std::size_t i, double max_depth) const
{
  if (i >= frames_.size())
    badParameter("frame ", i, " is beyond the ", frames_.size(), " of the sequence");
  if (!(max_depth >= 0.0))
    badParameter("max_depth is ", max_depth, " m, expected 0 (unlimited) or more");
  const Files& files = frames_[i];
  const cv::Mat image = readImage(files.colour);
  if (image.size() != cv::Size(camera_.width, camera_.height))
    badInput(files.colour, ": has ", image.cols, " x ", image.rows,
             " pixels, expected those of ", frames_.front().colour, ", ", camera_.width,
             " x ", camera_.height);
  const cv::Mat depths =
      readPng(files.depth, ImageKind::disparity, image.size(), " as " + files.colour);
  RgbdFrame frame{{files.number, files.time}, colourImage(image), {}};
  frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>(
      std::uint32_t(image.cols), std::uint32_t(image.rows));
  frame.cloud->is_dense = false;
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      pcl::PointXYZRGB& point = (*frame.cloud)(u, v);
      const std::uint16_t depth = depths.at<std::uint16_t>(v, u);
      const double z = double(depth) / depth_scale_;
      frame.unmeasured += !isMeasuredDepth(depth);
      if (isMeasuredDepth(depth) && (max_depth == 0.0 || z <= max_depth))
        point.getVector3fMap() << float((u - camera_.cx) / camera_.fx * z),
            float((v - camera_.cy) / camera_.fy * z), float(z);
      else
        point.getVector3fMap().setConstant(none);
      const auto& bgr = frame.image.at<cv::Vec3b>(v, u);
      point.b = bgr[0];
      point.g = bgr[1];
      point.r = bgr[2];
    }
  return frame;
}

} // namespace pcl_semantic
