// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_layout.h"

#include "core/fail.h"
#include "core/split.h"
#include "files/file_pattern.h"
#include "files/is_there.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

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

RgbdLayout
layoutOfTum(const std::string& folder, double depth_within)
{
  RgbdLayout layout;
  layout.is_tum = layout.has_times = true;
  const std::vector<TimedFile> depths = readList(folder, "depth.txt");
  const std::vector<TimedFile> colours = readList(folder, "rgb.txt");
  for (std::size_t number = 0; number < colours.size(); ++number) {
    const TimedFile& colour = colours[number];
    const auto nearest = std::min_element(
        depths.begin(), depths.end(), [&](const TimedFile& a, const TimedFile& b) {
          return std::abs(a.time - colour.time) < std::abs(b.time - colour.time);
        });
    if (std::abs(nearest->time - colour.time) <= depth_within)
      layout.frames.push_back(
          {colour.word, colour.path, nearest->path, "", colour.time, int(number)});
  }
  if (layout.frames.empty())
    fail<BadInputException>(folder, "/depth.txt: no time is within ", depth_within,
                            " s of one in rgb.txt; --depth-within allows more");
  if (const std::size_t skipped = colours.size() - layout.frames.size(); skipped > 0) {
    TextStream text;
    text << folder << "/rgb.txt: " << skipped << " of its " << colours.size()
         << " images have no depth image within " << depth_within
         << " s and are skipped; --depth-within allows more";
    layout.doubts.push_back(text.str());
  }
  if (isThere(folder + "/groundtruth.txt"))
    layout.poses = folder + "/groundtruth.txt";
  return layout;
}

// The depth image of a name without extension.
std::string
depthOf(const std::string& stem, const std::string& colour)
{
  for (const char* const extension : {".png", ".tif", ".tiff", ".PNG", ".TIF", ".TIFF"})
    if (isThere(stem + extension))
      return stem + extension;
  badInput(stem, ".png: is missing, the depth image of ", colour);
}

// "1305031102.175304": seconds with a point, in rising order.
void
takeTimesFromNames(RgbdLayout& layout)
{
  std::vector<double> times;
  for (const RgbdLayout::Files& files : layout.frames) {
    if (files.name.find_first_not_of("0123456789.") != std::string::npos ||
        std::count(files.name.begin(), files.name.end(), '.') != 1)
      return;
    times.push_back(parseNumber(files.name, files.colour));
    if (times.size() > 1 && times.back() <= times[times.size() - 2])
      return;
  }
  layout.has_times = true;
  for (std::size_t i = 0; i < times.size(); ++i)
    layout.frames[i].time = times[i];
}

RgbdLayout
layoutOfFolders(const std::string& folder, const std::string& colours)
{
  RgbdLayout layout;
  for (const std::string& colour : findFiles(colours, imageExtensions())) {
    const std::string name = fs::path(colour).stem().string();
    layout.frames.push_back({name, colour, depthOf(folder + "/depth/" + name, colour),
                             "", 0.1 * double(layout.frames.size()),
                             int(layout.frames.size())});
  }
  takeTimesFromNames(layout);
  const std::size_t depths = findFiles(folder + "/depth", imageExtensions()).size();
  if (depths > layout.frames.size())
    layout.doubts.push_back(
        folder + "/depth: " + std::to_string(depths - layout.frames.size()) +
        " of its images have no colour image in " + colours + " and are ignored");
  if (isThere(folder + "/groundtruth.txt"))
    layout.poses = folder + "/groundtruth.txt";
  else if (isFolder(folder + "/pose")) {
    layout.poses = folder + "/pose";
    for (RgbdLayout::Files& files : layout.frames)
      files.pose = layout.poses + "/" + files.name + ".txt";
  }
  return layout;
}

RgbdLayout
layoutOf7Scenes(const std::string& folder, const std::vector<std::string>& colours)
{
  RgbdLayout layout;
  for (const std::string& colour : colours) {
    const std::string name = fs::path(colour).stem().stem().string();
    layout.frames.push_back(
        {name, colour, depthOf(folder + "/" + name + ".depth", colour), "",
         0.1 * double(layout.frames.size()), int(layout.frames.size())});
  }
  if (filesEndingIn(".pose.txt", folder).empty())
    return layout;
  layout.poses = folder;
  layout.pose_frame = PoseFrame::first_camera; // axes of a camera
  for (RgbdLayout::Files& files : layout.frames)
    files.pose = folder + "/" + files.name + ".pose.txt";
  return layout;
}

} // namespace

RgbdLayout
rgbdLayoutOf(const std::string& folder, double depth_within)
{
  std::vector<std::string> of_frames = filesEndingIn(".color.png", folder);
  if (of_frames.empty())
    of_frames = filesEndingIn(".color.jpg", folder);
  const bool has_rgb = isFolder(folder + "/rgb"),
             has_color = isFolder(folder + "/color");
  RgbdLayout layout;
  if (isThere(folder + "/rgb.txt"))
    layout = layoutOfTum(folder, depth_within);
  else if (!of_frames.empty())
    layout = layoutOf7Scenes(folder, of_frames);
  else {
    const std::string colours = folder + (has_rgb ? "/rgb" : "/color");
    if (!isFolder(colours) || !isFolder(folder + "/depth"))
      badInput(folder, ": is no RGB-D sequence, expected folders rgb (or color) and "
                       "depth, rgb.txt and depth.txt (TUM), or frame-N.color.png and "
                       "frame-N.depth.png (7-Scenes)");
    layout = layoutOfFolders(folder, colours);
  }
  const bool uses_frames = !layout.is_tum && !of_frames.empty();
  if ((has_rgb && has_color) || (!of_frames.empty() && (has_rgb || layout.is_tum)))
    layout.doubts.push_back(
        folder + ": has colour images in two layouts; those in " +
        fs::path(layout.frames.front().colour).parent_path().string() +
        (uses_frames ? " named frame-N.color" : "") + " are used");
  return layout;
}

} // namespace pcl_semantic
