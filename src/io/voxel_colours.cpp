// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/voxel_colours.h>

#include "core/fail.h"
#include "label_changes.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace pcl_semantic {

namespace {

const cv::Vec3b grey_of_unlabelled(165, 165, 165);
const cv::Vec3b grey_of_unchanged(226, 224, 222);

// Label sets have dark colours, meant to be seen flat. Shaded ones have to be lighter.
cv::Vec3b
lighter(const cv::Vec3b& colour)
{
  cv::Vec3b result;
  for (int c = 0; c < 3; ++c)
    result[c] = cv::saturate_cast<std::uint8_t>(
        18.0 + 237.0 * std::pow(colour[c] / 255.0, 0.72));
  return result;
}

cv::Vec3b
solidColour(const LabelSet& label_set, Label label)
{
  return label == kUnlabelled ? grey_of_unlabelled
                              : lighter(classColour(label_set, label));
}

// 1234567 as 1 234 567.
std::string
grouped(std::size_t number)
{
  std::string text = std::to_string(number);
  for (int at = int(text.size()) - 3; at > 0; at -= 3)
    text.insert(std::size_t(at), " ");
  return text;
}

std::string
sizeOf(const VoxelScene& scene)
{
  return grouped(scene.voxels.size()) +
         cv::format(" voxels of %.4g m", scene.grid.size);
}

std::vector<Label>
labelsOf(const VoxelScene& scene)
{
  std::vector<Label> labels;
  labels.reserve(scene.voxels.size());
  for (const pcl::PointXYZRGBL& point : *scene.voxels.cloud)
    labels.push_back(static_cast<Label>(point.label));
  return labels;
}

// A colour for a number, neighbours far apart: saturated enough to differ, never dark.
cv::Vec3b
colourOfNumber(std::uint32_t number)
{
  std::uint32_t hash = number * 2654435761u;
  hash ^= hash >> 15;
  hash *= 2246822519u;
  const cv::Vec3b hsv(static_cast<std::uint8_t>(hash % 180),
                      static_cast<std::uint8_t>(90 + (hash >> 8) % 120),
                      static_cast<std::uint8_t>(170 + (hash >> 16) % 80));
  cv::Mat colour(1, 1, CV_8UC3, cv::Scalar(hsv));
  cv::cvtColor(colour, colour, cv::COLOR_HSV2BGR);
  return colour.at<cv::Vec3b>(0, 0);
}

// The ramp of entropy: 256 colours from pale yellow to dark violet.
cv::Mat
uncertaintyRamp()
{
  cv::Mat values(1, 256, CV_8UC1), ramp;
  for (int i = 0; i < 256; ++i)
    values.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(255 - i);
  cv::applyColorMap(values, ramp, cv::COLORMAP_VIRIDIS);
  return ramp;
}

void
requireField(bool is_there, const char* what, const char* field)
{
  if (!is_there)
    badParameter("the points have no ", what, ", expected a field ", field);
}

} // namespace

VoxelColours
classColours(const VoxelScene& scene, const LabelSet& label_set)
{
  VoxelColours result;
  std::array<std::size_t, 256> counts{};
  for (const Label label : labelsOf(scene)) {
    if (label > label_set.size())
      badParameter("label ", int(label), " is beyond the ", label_set.size(),
                   " classes of the label set");
    ++counts[label];
    result.colours.push_back(solidColour(label_set, label));
  }
  for (int label = 1; label <= label_set.size(); ++label)
    if (counts[std::size_t(label)] > 0)
      result.legend.push_back(
          {label_set[Label(label)].name, solidColour(label_set, Label(label))});
  if (counts[kUnlabelled] > 0)
    result.legend.push_back({"unlabelled", grey_of_unlabelled});
  result.note = sizeOf(scene);
  return result;
}

VoxelColours
measuredColours(const VoxelScene& scene)
{
  requireField(scene.has_colour, "colour", "rgb or rgba");
  VoxelColours result;
  for (const pcl::PointXYZRGBL& point : *scene.voxels.cloud)
    result.colours.emplace_back(point.b, point.g, point.r);
  result.note = sizeOf(scene);
  return result;
}

VoxelColours
entropyColours(const VoxelScene& scene)
{
  const LabelDistributions& distributions = scene.voxels.refined;
  requireField(distributions.size() == Eigen::Index(scene.voxels.size()),
               "distributions", "probability");
  const cv::Mat ramp = uncertaintyRamp();
  const double largest = std::log(std::max(2, distributions.classes()));
  VoxelColours result;
  for (Eigen::Index i = 0; i < distributions.size(); ++i) {
    const double part = distributions.entropy(i) / largest;
    result.colours.push_back(
        ramp.at<cv::Vec3b>(0, std::clamp(cvRound(255.0 * part), 0, 255)));
  }
  for (int quarter = 0; quarter <= 4; ++quarter)
    result.legend.push_back({cv::format("%.2f", 0.25 * quarter * largest) +
                                 (quarter == 0   ? " nat: certain"
                                  : quarter == 4 ? " nat: any class"
                                                 : ""),
                             ramp.at<cv::Vec3b>(0, std::min(255, 64 * quarter))});
  result.note = "entropy of the labels of " + sizeOf(scene);
  return result;
}

VoxelColours
observationColours(const VoxelScene& scene)
{
  const std::vector<std::uint32_t>& observations = scene.voxels.observations;
  requireField(observations.size() == scene.voxels.size(), "numbers of observations",
               "observations");
  constexpr int steps = 8; // 1, 2 to 3, 4 to 7, ... 128 and more
  const cv::Mat ramp = uncertaintyRamp();
  const auto colourOf = [&](int step) {
    return ramp.at<cv::Vec3b>(0, 255 - 255 * step / (steps - 1));
  };
  VoxelColours result;
  for (const std::uint32_t count : observations) {
    int step = 0;
    while (step + 1 < steps && count >> (step + 1) > 0)
      ++step;
    result.colours.push_back(colourOf(step));
  }
  for (int step = 0; step < steps; ++step) {
    const int low = 1 << step, high = 2 * low - 1;
    result.legend.push_back({step == 0           ? "1 scan"
                             : step == steps - 1 ? cv::format("%d and more", low)
                                                 : cv::format("%d to %d", low, high),
                             colourOf(step)});
  }
  result.note = "scans that hit each of " + sizeOf(scene);
  return result;
}

VoxelColours
cliqueColours(const VoxelScene& scene)
{
  requireField(scene.cliques.size() == scene.voxels.size(), "cliques", "clique");
  VoxelColours result;
  std::set<std::uint32_t> numbers;
  for (const std::uint32_t clique : scene.cliques) {
    result.colours.push_back(clique == 0 ? grey_of_unchanged : colourOfNumber(clique));
    numbers.insert(clique);
  }
  if (numbers.erase(0) > 0)
    result.legend.push_back({"in no clique", grey_of_unchanged});
  result.note = grouped(numbers.size()) + " cliques, " + sizeOf(scene);
  return result;
}

VoxelColours
changeColours(const VoxelScene& scene, const std::vector<Label>& before,
              const LabelSet& label_set)
{
  constexpr std::size_t max_kinds = 9;
  const std::vector<Label> after = labelsOf(scene);
  const LabelChanges changes = countLabelChanges(before, after);
  VoxelColours result = classColours(scene, label_set);
  result.shading = 0.6; // what is grey stays pale, so that the colours stand out
  for (std::size_t i = 0; i < after.size(); ++i)
    if (before[i] == kUnlabelled || before[i] == after[i] || after[i] == kUnlabelled)
      result.colours[i] = grey_of_unchanged;
  result.legend.clear();
  std::size_t named = 0;
  for (std::size_t i = 0; i < std::min(max_kinds, changes.kinds.size()); ++i) {
    const LabelChange& kind = changes.kinds[i];
    result.legend.push_back({label_set[kind.from].name + " > " +
                                 label_set[kind.to].name + " " + grouped(kind.count),
                             solidColour(label_set, kind.to)});
    named += kind.count;
  }
  result.note = grouped(changes.changed) + " of " + grouped(changes.compared) +
                cv::format(" voxels changed their class (%.1f %%)",
                           100.0 * double(changes.changed) /
                               double(std::max<std::size_t>(1, changes.compared)));
  if (named < changes.changed)
    result.note += ", " + grouped(changes.changed - named) + " in other ways";
  result.legend.push_back({"unchanged", grey_of_unchanged});
  return result;
}

} // namespace pcl_semantic
