// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/voxel_colours.h>

#include "core/fail.h"
#include "core/label_number.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

const cv::Vec3b grey_of_unlabelled(165, 165, 165);
const cv::Vec3b grey_of_unchanged(226, 224, 222);

// Label sets have dark colours for flat images; shaded images need lighter ones.
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

// Formats 1234567 as 1 234 567.
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
    labels.push_back(requireLabel(point.label));
  return labels;
}

// Number of voxels with a label change.
struct LabelChange {
  Label from = kUnlabelled, to = kUnlabelled;
  std::size_t count = 0;
};

// The most frequent first, then by label. Unlabelled voxels are not compared.
std::vector<LabelChange>
changesOf(const std::vector<Label>& before, const std::vector<Label>& after)
{
  std::vector<std::size_t> counts(256 * 256, 0);
  for (std::size_t i = 0; i < after.size(); ++i)
    if (before[i] != kUnlabelled && after[i] != kUnlabelled && before[i] != after[i])
      ++counts[std::size_t(before[i]) * 256 + after[i]];
  std::vector<LabelChange> changes;
  for (std::size_t pair = 0; pair < counts.size(); ++pair)
    if (counts[pair] > 0)
      changes.push_back({Label(pair / 256), Label(pair % 256), counts[pair]});
  std::stable_sort(
      changes.begin(), changes.end(),
      [](const LabelChange& a, const LabelChange& b) { return a.count > b.count; });
  return changes;
}

// Colour map of entropy: 256 colours from pale yellow to dark violet.
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
changeColours(const VoxelScene& scene, const std::vector<Label>& before,
              const LabelSet& label_set)
{
  constexpr std::size_t max_kinds = 9;
  if (before.size() != scene.voxels.size())
    badParameter(before.size(), " labels before of ", scene.voxels.size(), " voxels");
  const std::vector<Label> after = labelsOf(scene);
  VoxelColours result = classColours(scene, label_set);
  result.shading = 0.6; // grey voxels stay pale, so that the colours stand out
  std::size_t compared = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const bool is_known = before[i] != kUnlabelled && after[i] != kUnlabelled;
    compared += is_known;
    if (!is_known || before[i] == after[i])
      result.colours[i] = grey_of_unchanged;
  }
  result.legend.clear();
  std::size_t changed = 0, named = 0;
  for (const LabelChange& change : changesOf(before, after)) {
    changed += change.count;
    if (result.legend.size() == max_kinds)
      continue;
    result.legend.push_back({label_set[change.from].name + " > " +
                                 label_set[change.to].name + " " +
                                 grouped(change.count),
                             solidColour(label_set, change.to)});
    named += change.count;
  }
  result.note =
      grouped(changed) + " of " + grouped(compared) +
      cv::format(" voxels changed their class (%.1f %%)",
                 100.0 * double(changed) / double(std::max<std::size_t>(1, compared)));
  if (named < changed)
    result.note += ", " + grouped(changed - named) + " in other ways";
  result.legend.push_back({"unchanged", grey_of_unchanged});
  return result;
}

} // namespace pcl_semantic
