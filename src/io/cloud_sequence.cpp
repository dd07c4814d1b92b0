// SPDX-License-Identifier: BSD-3-Clause
#include "files/file_pattern.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/labelled_cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/cloud_sequence.h>

#include <pcl/common/io.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>

namespace pcl_semantic {

namespace {

// The whole of a name without extension as a number, if it is one.
template <typename Number>
std::optional<Number>
numberOf(const std::string& path)
{
  const std::string name = std::filesystem::path(path).stem().string();
  Number number{};
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, number);
  if (error != std::errc() || stop != end || !(name[0] >= '0' && name[0] <= '9'))
    return std::nullopt;
  return number;
}

// The frame number that a name is; nothing if it is a time, or a word.
std::optional<int>
frameNumberOf(const std::string& path)
{
  constexpr std::int64_t end = 100000000;
  const auto number = numberOf<std::int64_t>(path);
  return number && *number < end ? std::optional<int>(int(*number)) : std::nullopt;
}

// Times beyond 1e17 are nanoseconds, as in files of times.
std::optional<double>
timeInName(const std::string& path)
{
  auto time = numberOf<double>(path);
  if (time && *time > 1e17)
    time = *time * 1e-9;
  return time;
}

// What `of` says of all paths; empty if it says nothing of one.
template <typename Number, typename Of>
std::vector<Number>
ofAll(const std::vector<std::string>& paths, Of&& of)
{
  std::vector<Number> all;
  for (const std::string& path : paths)
    if (const auto number = of(path))
      all.push_back(*number);
  return all.size() == paths.size() ? all : std::vector<Number>();
}

LabelDistributions
distributionsOf(const LabelledCloud& read, const std::string& path, int classes,
                float confidence)
{
  if (!read.has_labels)
    return {};
  if (const int found = read.distributions.classes(); found > 0) {
    if (found != classes)
      PCL_THROW_EXCEPTION(BadInputException, path << ": has probabilities of " << found
                                                  << " classes, expected " << classes);
    return read.distributions;
  }
  LabelDistributions distributions(classes, Eigen::Index(read.cloud->size()));
  for (std::size_t i = 0; i < read.cloud->size(); ++i) {
    const std::uint32_t label = (*read.cloud)[i].label;
    if (label > std::uint32_t(classes))
      PCL_THROW_EXCEPTION(BadInputException, path << ": point " << i << " has label "
                                                  << label << ", expected 0 to "
                                                  << classes << ", or a label mapping");
    distributions.setLabel(Eigen::Index(i), Label(label), confidence);
  }
  return distributions;
}

} // namespace

CloudSequence::CloudSequence(const std::string& pattern, const std::string& times)
    : paths_(findFiles(pattern, cloudExtensions()))
{
  numbers_ = ofAll<int>(paths_, frameNumberOf);
  for (std::size_t i = 1; i < numbers_.size(); ++i)
    if (numbers_[i] == numbers_[i - 1])
      PCL_THROW_EXCEPTION(BadInputException, paths_[i - 1] << " and " << paths_[i]
                                                           << ": are both frame "
                                                           << numbers_[i]);
  if (numbers_.empty()) {
    times_ = ofAll<double>(paths_, timeInName);
    if (!times_.empty()) // not the natural order: 0.25 comes before 0.5
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
      PCL_THROW_EXCEPTION(BadInputException, times << ": has " << rows.size()
                                                   << " times, but frame " << number
                                                   << " is there (row = frame number)");
    times_.push_back(times.empty() ? 0.1 * number : rows[std::size_t(number)]);
  }
}

CloudFrame
CloudSequence::frame(std::size_t i, int classes, float confidence,
                     const LabelMapping* mapping) const
{
  const LabelledCloud read = readLabelledCloud(path(i), mapping);
  CloudFrame frame{{frameNumber(i), timestamp(i)}, {}, {}, read.has_colour};
  frame.cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
  pcl::copyPointCloud(*read.cloud, *frame.cloud);
  frame.distributions = distributionsOf(read, path(i), classes, confidence);
  return frame;
}

} // namespace pcl_semantic
