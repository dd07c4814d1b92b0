// SPDX-License-Identifier: BSD-3-Clause
#include "evaluated_folders.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>

#include <opencv2/core.hpp>

#include <filesystem>

namespace pcl_semantic::tool {

namespace {

namespace fs = std::filesystem;

// Labels of a scan as an image of one row.
cv::Mat
asImage(const std::vector<Label>& labels)
{
  return cv::Mat(1, static_cast<int>(labels.size()), CV_8UC1,
                 const_cast<Label*>(labels.data()))
      .clone();
}

cv::Mat
readLabelFile(const std::string& path, int classes)
{
  return fs::path(path).extension() == ".label" ? asImage(readScanLabels(path, classes))
                                                : readPng(path, ImageKind::labels);
}

cv::Mat
readTruth(const std::string& path, const cv::Mat& prediction, int classes,
          const LabelMapping* mapping)
{
  if (!mapping || fs::path(path).extension() != ".label")
    return readLabelFile(path, classes);
  return asImage(readSemanticKittiLabels(path, *mapping, prediction.total()));
}

cv::Mat
readTruthDepth(const std::string& folder, const std::string& truth_path,
               const cv::Mat& truth)
{
  const fs::path name = fs::path(truth_path).filename();
  const std::string path =
      (fs::path(folder) / name)
          .replace_extension(name.extension() == ".label" ? ".bin" : ".png")
          .string();
  cv::Mat depth = readDepths(path);
  if (depth.size() != truth.size())
    PCL_THROW_EXCEPTION(BadInputException, path << ": has " << depth.cols << " x "
                                                << depth.rows
                                                << " depths, the ground truth "
                                                << truth.cols << " x " << truth.rows);
  return depth;
}

// The ground truth whose depth lies in the range; 0 elsewhere.
cv::Mat
truthIn(const DepthRange& range, const cv::Mat& truth, const cv::Mat& depth)
{
  cv::Mat inside = cv::Mat::zeros(truth.size(), CV_8UC1);
  truth.copyTo(inside, (depth > 0.0) & (depth >= range.from) & (depth < range.to));
  return inside;
}

std::string
existing(const std::string& folder, const std::string& name, const std::string& truth)
{
  const std::string path = folder + "/" + name;
  if (!fs::exists(path))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": is missing, expected as the prediction for "
                             << truth);
  return path;
}

} // namespace

DepthRange
parseDepthRange(const std::string& text)
{
  DepthRange range;
  const std::size_t colon = text.find(':');
  const std::string from = text.substr(0, colon);
  const std::string to = colon == std::string::npos ? "" : text.substr(colon + 1);
  bool valid = colon != std::string::npos;
  try {
    if (!from.empty())
      range.from = parseNumber(from, "");
    if (!to.empty())
      range.to = parseNumber(to, "");
  }
  catch (const BadInputException&) {
    valid = false;
  }
  if (!valid || !(range.from >= 0.0 && range.from < range.to))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--range is '" << text << "', expected A:B with 0 <= A < B");
  range.text = to.empty() ? "from " + from + " m"
                          : (from.empty() ? "0" : from) + "-" + to + " m";
  return range;
}

std::vector<ConfusionMatrix>
compareFolders(const EvaluatedFolders& folders, const std::vector<DepthRange>& ranges,
               const LabelSet& label_set, const LabelMapping* mapping)
{
  const std::vector<FrameFile> files =
      listFrameFiles(folders.truth, {".png", ".label"});
  if (files.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        folders.truth
                            << ": holds no ground truth, expected 000000.png or "
                               "000000.label ...");
  std::vector<ConfusionMatrix> result(std::max<std::size_t>(ranges.size(), 1),
                                      ConfusionMatrix(label_set.size()));
  for (const FrameFile& file : files) {
    const std::string name = fs::path(file.path).filename().string();
    const std::string path = existing(folders.prediction, name, file.path);
    const cv::Mat prediction = readLabelFile(path, label_set.size());
    const cv::Mat truth = readTruth(file.path, prediction, label_set.size(), mapping);
    const cv::Mat covered = folders.covered_by.empty()
                                ? cv::Mat()
                                : readLabelFile(folders.covered_by + "/" + name, 255);
    const cv::Mat depth = ranges.empty()
                              ? cv::Mat()
                              : readTruthDepth(folders.truth_depth, file.path, truth);
    try {
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i].add(ranges.empty() ? truth : truthIn(ranges[i], truth, depth),
                      prediction, covered);
    }
    catch (const BadInputException& error) {
      PCL_THROW_EXCEPTION(BadInputException,
                          path << " against " << file.path << ": " << error.what());
    }
  }
  return result;
}

} // namespace pcl_semantic::tool
