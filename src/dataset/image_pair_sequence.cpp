// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/image_pair_sequence.h>

#include "core/fail.h"
#include "files/file_pattern.h"
#include "stereo_pair_reader.h"

#include <pcl_semantic/images/image_file.h>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic {

namespace {

using Paths = std::vector<std::string>;
using Numbers = std::vector<std::string>;

// The numbers in each path that differ between paths, such as frame numbers. Empty if
// the paths have different amounts of numbers.
std::vector<Numbers>
countingNumbers(const Paths& paths)
{
  std::vector<Numbers> all;
  for (const std::string& path : paths)
    all.push_back(numbersIn(path));
  std::vector<Numbers> counting(all.size());
  for (const Numbers& numbers : all)
    if (numbers.size() != all[0].size())
      return {};
  for (std::size_t k = 0; k < all[0].size(); ++k)
    if (std::any_of(all.begin(), all.end(),
                    [&](const Numbers& numbers) { return numbers[k] != all[0][k]; }))
      for (std::size_t i = 0; i < all.size(); ++i)
        counting[i].push_back(all[i][k]);
  return counting;
}

// An image missing in the middle of one side would shift all later pairs.
void
requirePairs(const Paths& left, const Paths& right, const ImagePairFiles& files)
{
  const std::vector<Numbers> a = countingNumbers(left), b = countingNumbers(right);
  const std::size_t both = std::min(left.size(), right.size());
  for (std::size_t i = 0; i < both; ++i) {
    if (left[i] == right[i])
      fail<BadInputException>(left[i],
                              ": is both the left and the right image of frame ", i);
    if (!a.empty() && !b.empty() && a[i].size() == b[i].size() && a[i] != b[i])
      fail<BadInputException>(left[i], " and ", right[i],
                              ": have different numbers, but would be frame ", i,
                              " (pairs are made by position)");
  }
  if (left.size() != right.size())
    fail<BadInputException>(files.left, ": matches ", left.size(), " files, but ",
                            files.right, " matches ", right.size());
}

// Names that are times in nanoseconds, as EuRoC's; else empty.
std::vector<double>
timesInNames(const Paths& paths)
{
  std::vector<double> times;
  for (const std::string& path : paths) {
    const std::string name = frameNameOf(path);
    constexpr std::size_t least = 17, most = 19; // digits
    if (name.size() < least || name.size() > most ||
        name.find_first_not_of("0123456789") != std::string::npos)
      return {};
    times.push_back(1e-9 * std::stod(name));
    if (times.size() > 1 && !(times.back() > times[times.size() - 2]))
      return {};
  }
  return times;
}

} // namespace

ImagePairSequence::ImagePairSequence(const ImagePairFiles& files)
    : left_(findFiles(files.left, imageExtensions())),
      right_(findFiles(files.right, imageExtensions()))
{
  requirePairs(left_, right_, files);
  const cv::Mat first = readFrameImage(left_.front(), 0);
  pair_ = readRectifiedPair(
      {files.calibration, files.extrinsics}, {first.size(), left_.front()},
      first.channels() == 1 ? KittiCameras::grey : KittiCameras::colour);
  times_ = files.times.empty()
               ? timesInNames(left_)
               : readTimesOf(files.times, left_.size(), "pairs (row = pair)");
}

StereoFrame
ImagePairSequence::frame(std::size_t i) const
{
  StereoFrame frame = readStereoPair({left_.at(i), right_.at(i), frameNumber(i)},
                                     {camera().width, camera().height});
  frame.timestamp = timestamp(i);
  pair_.rectify(frame);
  return frame;
}

bool
isVideo(const std::string& path)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".mp4" || extension == ".avi" || extension == ".mkv" ||
         extension == ".mov";
}

} // namespace pcl_semantic
