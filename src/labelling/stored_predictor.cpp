// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/stored_predictor.h>

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/distribution_file.h>

#include <filesystem>

namespace pcl_semantic {

namespace fs = std::filesystem;

StoredPredictor::StoredPredictor(const std::string& folder, int classes,
                                 float png_confidence, PixelMapping mapping)
    : folder_(folder), classes_(classes), png_confidence_(png_confidence),
      mapping_(std::move(mapping))
{
  if (classes < 1 || classes > 255)
    fail<InvalidParameterException>("number of classes is ", classes,
                                    ", expected 1 to 255");
  if (!(png_confidence > 0.0f && png_confidence <= 1.0f))
    fail<InvalidParameterException>("confidence of stored labels is ", png_confidence,
                                    ", expected more than 0, up to 1");
  std::error_code error;
  if (!fs::is_directory(folder, error))
    fail<BadInputException>(folder, ": is no folder of stored labels",
                            error ? ": " + error.message() : "");
}

std::string
StoredPredictor::findFile(int frame) const
{
  std::string found;
  for (const std::string& extension : distributionExtensions()) {
    const std::string name = frameFileName(frame, extension);
    const std::string path = (fs::path(folder_) / name).string();
    std::error_code error;
    const bool is_there = fs::exists(path, error);
    if (error)
      fail<BadInputException>(path, ": cannot be read: ", error.message());
    if (!is_there)
      continue;
    if (!found.empty())
      fail<BadInputException>(folder_, ": frame ", frame, " has two files of labels, ",
                              fs::path(found).filename().string(), " and ", name);
    found = path;
  }
  if (found.empty())
    fail<BadInputException>(folder_, ": frame ", frame, " has no labels: expected ",
                            frameFileName(frame, ".bin"), ", .npy, .npy.zst or .png");
  return found;
}

void
StoredPredictor::requireFrames(const std::vector<int>& frames) const
{
  for (const int frame : frames)
    findFile(frame);
}

LabelDistributions
StoredPredictor::predict(const cv::Mat& image, int frame)
{
  return readDistributions(findFile(frame), image.cols, image.rows, classes_,
                           png_confidence_, mapping_);
}

} // namespace pcl_semantic
