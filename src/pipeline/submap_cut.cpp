// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/submap_cut.h>

#include "core/fail.h"

#include <charconv>
#include <cmath>

namespace pcl_semantic {

SubmapLength
parseSubmapLength(const std::string& text, const MapInputs& inputs)
{
  if (inputs.poses == "viewpoint")
    badParameter("--poses viewpoint and --submap-every exclude each other: submaps are "
                 "cut before the clouds are read");
  SubmapLength length;
  const bool is_metres = !text.empty() && text.back() == 'm';
  const char* const end = text.data() + text.size() - (is_metres ? 1 : 0);
  double number = 0.0;
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc() || read.ptr != end || !(number > 0.0 && number <= 1e9) ||
      (!is_metres && number != std::floor(number)))
    badParameter("--submap-every is '", text,
                 "', expected metres (50m) or frames (100)");
  if (is_metres)
    length.metres = number;
  else
    length.frames = int(number);
  return length;
}

std::vector<SubmapFrames>
cutIntoSubmaps(const OpenedInputs& inputs, const SubmapLength& length)
{
  const std::vector<FrameTime>& frames = inputs.source->frames();
  if (inputs.has_odometry)
    badParameter("--submap-every needs poses from a file: write them with "
                 "pcl_semantic_odometry and give them with --poses");
  inputs.poses->requirePoses(frames);
  std::vector<Eigen::Vector3d> positions;
  for (const FrameTime& frame : frames)
    positions.push_back(poseAt(*inputs.poses, frame).translation());
  const std::vector<std::size_t> starts = submapStarts(positions, length);
  std::vector<SubmapFrames> submaps;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t first = starts[i];
    const std::size_t last =
        i + 1 < starts.size() ? starts[i + 1] - 1 : frames.size() - 1;
    submaps.push_back({std::to_string(frames[first].number) + ":" +
                           std::to_string(frames[last].number + 1),
                       frames[first + (last - first + 1) / 2]});
  }
  return submaps;
}

} // namespace pcl_semantic
