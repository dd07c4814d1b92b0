// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/cloud_sequence.h>

#include "core/fail.h"
#include "files/file_pattern.h"

#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <boost/algorithm/string/predicate.hpp>
#include <pcl/common/io.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

namespace pcl_semantic {

namespace {

// Times above 1e17 are nanoseconds, as in files of times. None if the name is no time.
std::optional<double>
timeInName(const std::string& path)
{
  const std::string name = frameNameOf(path);
  double time = 0.0;
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, time);
  if (error != std::errc() || stop != end || !(name[0] >= '0' && name[0] <= '9'))
    return std::nullopt;
  return time > 1e17 ? time * 1e-9 : time;
}

// Times of all paths; empty if one has none.
std::vector<double>
timesInNames(const std::vector<std::string>& paths)
{
  std::vector<double> all;
  for (const std::string& path : paths)
    if (const auto time = timeInName(path))
      all.push_back(*time);
  return all.size() == paths.size() ? all : std::vector<double>();
}

bool
isHeaderless(const std::string& path)
{
  return boost::algorithm::iends_with(path, ".bin");
}

// The pose of a frame would displace a cloud that is already in the world's frame.
void
requireFrameOfSensor(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud,
                     const std::string& path)
{
  constexpr float farthest = 1e4f; // range of a scanner [m]
  std::size_t seen = 0, far = 0;
  for (const pcl::PointXYZRGBL& point : cloud)
    if (isReturn(point)) {
      ++seen;
      far += point.getVector3fMap().norm() > farthest;
    }
  if (2 * far > seen)
    badInput(path, ": ", far, " of ", seen, " points are more than ", farthest,
             " m from the origin, as in the world frame; expected points in the sensor "
             "frame, which the poses move into the world");
}

LabelDistributions
distributionsOf(const LabelledCloud& read, const std::string& path, int classes,
                float confidence)
{
  if (!read.has_labels)
    return {};
  if (const int found = read.distributions.classes(); found > 0) {
    if (found != classes)
      badInput(path, ": has probabilities of ", found, " classes, expected ", classes);
    return read.distributions;
  }
  LabelDistributions distributions(classes, Eigen::Index(read.cloud->size()));
  for (std::size_t i = 0; i < read.cloud->size(); ++i) {
    const std::uint32_t label = (*read.cloud)[i].label;
    if (label > std::uint32_t(classes))
      badInput(path, ": point ", i, " has label ", label, ", expected 0 to ", classes,
               ", or a label mapping");
    distributions.setLabel(Eigen::Index(i), Label(label), confidence);
  }
  return distributions;
}

} // namespace

CloudSequence::CloudSequence(const std::string& pattern, const std::string& times,
                             ScanColumns columns)
    : paths_(findFiles(pattern, cloudExtensions())), columns_(std::move(columns))
{
  if (!columns_.empty() && std::none_of(paths_.begin(), paths_.end(), isHeaderless))
    badParameter(pattern, ": scan columns are for .bin, which has no header");
  numbers_ = frameNumbersOf(paths_);
  if (numbers_.empty()) {
    times_ = timesInNames(paths_);
    if (!times_.empty()) // numeric order: natural order puts 0.25 before 0.5
      std::sort(paths_.begin(), paths_.end(), [](const auto& a, const auto& b) {
        return *timeInName(a) < *timeInName(b);
      });
    std::sort(times_.begin(), times_.end());
    for (std::size_t i = 0; i < paths_.size(); ++i)
      numbers_.push_back(int(i));
  }
  std::vector<double> rows;
  if (!times.empty())
    rows = readTimes(times);
  else if (!times_.empty())
    return;
  times_.clear();
  for (const int number : numbers_) {
    if (!times.empty() && std::size_t(number) >= rows.size())
      badInput(times, ": has ", rows.size(), " times, but frame ", number,
               " is there (row = frame number)");
    times_.push_back(times.empty() ? 0.1 * number : rows[std::size_t(number)]);
  }
}

CloudFrame
CloudSequence::frame(std::size_t i, int classes, float confidence,
                     const LabelMapping* mapping) const
{
  if (i >= size())
    badParameter("frame ", i, " is beyond the ", size(), " of the sequence");
  LabelledCloud read = readLabelledCloud(
      path(i), mapping, isHeaderless(path(i)) ? columns_ : ScanColumns());
  addOrigin(read);
  requireFrameOfSensor(*read.cloud, path(i));
  CloudFrame frame{{frameNumber(i), timestamp(i)}, {}, {}, read.has_colour};
  frame.path = path(i);
  frame.doubts = read.table.doubts;
  if (mapping && read.distributions.classes() > 0)
    frame.doubts.push_back(path(i) + ": a label mapping does not change its "
                                     "probabilities, which are used");
  const Eigen::Map<const Eigen::Vector4d> turn(read.table.viewpoint.data() + 3);
  if (turn.norm() > 1e-6)
    frame.viewpoint = viewpointOf(read.table, path(i));
  else // programs without a pose write a zero quaternion
    frame.viewpoint.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
  pcl::copyPointCloud(*read.cloud, *frame.cloud);
  frame.distributions = distributionsOf(read, path(i), classes, confidence);
  return frame;
}

} // namespace pcl_semantic
