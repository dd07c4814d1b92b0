// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/images/distribution_file.h>

#include "image_size.h"

#include "core/fail.h"
#include "core/probability_sums.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/npy_file.h>
#include <pcl_semantic/images/image_file.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <utility>

namespace pcl_semantic {

namespace {

LabelDistributions::Matrix
readBin(const std::string& path, int width, int height, int classes)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  LabelDistributions::Matrix values(classes, Eigen::Index(width) * height);
  const std::size_t expected = std::size_t(values.size()) * sizeof(float);
  if (bytes.size() != expected)
    badInput(path, ": has ", bytes.size(), " bytes, expected ", expected, " (", width,
             " x ", height, " pixels x ", classes, " classes x 4)");
  std::memcpy(values.data(), bytes.data(), expected);
  return values;
}

// Rounding to multiples of 1 / 255 changes the sums.
void
normalizeRounded(Eigen::MatrixXf& values, const std::string& path)
{
  const double tolerance = 0.1 + double(values.rows()) / 510.0;
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    const float sum = values.col(j).sum();
    if (sum == 0.0f)
      continue;
    if (std::abs(double(sum) - 1.0) > tolerance)
      badInput(path, ": pixel ", j, " has probabilities that sum to ", sum,
               ", expected 1 (255 in its units)");
    values.col(j) /= sum;
  }
}

LabelDistributions::Matrix
readNpyMatrix(const std::string& path, int width, int height, int classes)
{
  const std::size_t expected =
      std::size_t(width) * std::size_t(height) * std::size_t(classes);
  NpyArray array = readNpy(path, expected);
  if (array.width != width || array.height != height || array.depth != classes)
    badInput(path, ": has shape (", array.height, ", ", array.width, ", ", array.depth,
             "), expected (", height, ", ", width, ", ", classes, ")");
  if (array.is_rounded)
    normalizeRounded(array.values, path);
  return std::move(array.values);
}

LabelDistributions
readIds(const std::string& path, int width, int height, int classes, float confidence,
        const PixelMapping& mapping)
{
  const cv::Mat ids = readLabelImage(path, mapping, {width, height});
  LabelDistributions distributions(classes, Eigen::Index(width) * height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const int id = ids.at<std::uint8_t>(v, u);
      if (id > classes)
        badInput(path, ": pixel (", u, ", ", v, ") has class ", id, ", expected 0 to ",
                 classes);
      distributions.setLabel(Eigen::Index(v) * width + u, Label(id), confidence);
    }
  return distributions;
}

// Networks print sums slightly off one; far off, the file contains other data.
void
checkSums(const LabelDistributions::Matrix& values, const std::string& path, int width)
{
  const auto isValid = [&](Eigen::Index j) {
    return (values.col(j).array() >= 0.0f).all() && std::isfinite(values.col(j).sum());
  };
  Eigen::Index bad = values.cols();
#pragma omp parallel for schedule(static) reduction(min : bad)
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    const float sum = values.col(j).sum();
    if (!isValid(j) || !isSumOfProbabilities(double(sum)))
      bad = std::min(bad, j);
  }
  if (bad == values.cols())
    return;
  badInput(path, ": pixel (", bad % width, ", ", bad / width, ") ",
           isValid(bad) ? "has probabilities that sum to "
                        : "has a negative or non-finite probability; sum ",
           values.col(bad).sum(), ", expected 1");
}

int
rowsOf(const LabelDistributions& distributions, int width)
{
  if (width < 1 || distributions.size() % width != 0)
    badParameter("got ", distributions.size(), " pixels, expected rows of ", width);
  return int(distributions.size() / width);
}

} // namespace

cv::Size
statedImageSize(const std::string& path)
{
  const StatedSize size = statedSize(readBytes(path));
  const auto whole = [](std::uint64_t pixels) {
    return int(std::min<std::uint64_t>(pixels, std::numeric_limits<int>::max()));
  };
  return {whole(size.columns), whole(size.rows)};
}

cv::Mat
readLabelImage(const std::string& path, const PixelMapping& mapping, cv::Size size)
{
  if (const auto* const numbers = std::get_if<LabelMapping>(&mapping)) {
    cv::Mat ids;
    readPng(path, ImageKind::segments, size).convertTo(ids, CV_16U);
    cv::Mat1b labels(ids.size());
    std::transform(ids.begin<std::uint16_t>(), ids.end<std::uint16_t>(), labels.begin(),
                   *numbers);
    return labels;
  }
  const auto* const colours = std::get_if<ColourMapping>(&mapping);
  if (!colours)
    return readPng(path, ImageKind::labels, size);
  const cv::Mat image = readPng(path, ImageKind::grey_or_colour, size);
  if (image.channels() != 3)
    badInput(path, ": is grey, expected the colours of the classes");
  cv::Mat1b labels(image.size());
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const cv::Vec3b& bgr = image.at<cv::Vec3b>(v, u);
      const auto label = (*colours)(bgr[2], bgr[1], bgr[0]);
      if (!label)
        badInput(path, ": pixel (", u, ", ", v, ") has the colour ", int(bgr[2]), ", ",
                 int(bgr[1]), ", ", int(bgr[0]), ", expected that of a class");
      labels(v, u) = *label;
    }
  return labels;
}

bool
isPackedNpy(const std::string& path)
{
  const std::filesystem::path name(path);
  return name.extension() == ".zst" && name.stem().extension() == ".npy";
}

LabelDistributions
readDistributions(const std::string& path, int width, int height, int classes,
                  float confidence, const PixelMapping& mapping)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".png")
    return readIds(path, width, height, classes, confidence, mapping);
  if (extension != ".bin" && extension != ".npy" && !isPackedNpy(path))
    badInput(path, ": expected a file named .bin, .npy, .npy.zst or .png");
  LabelDistributions::Matrix values = extension == ".bin"
                                          ? readBin(path, width, height, classes)
                                          : readNpyMatrix(path, width, height, classes);
  checkSums(values, path, width);
  return LabelDistributions(std::move(values));
}

const std::vector<std::string>&
distributionExtensions()
{
  static const std::vector<std::string> all = {".bin", ".npy", ".npy.zst", ".png"};
  return all;
}

void
writeDistributions(const std::string& path, const LabelDistributions& distributions)
{
  writeBytes(path, distributions.matrix().data(),
             std::size_t(distributions.matrix().size()) * sizeof(float));
}

void
writeDistributions(const std::string& path, const LabelDistributions& distributions,
                   int width, NpyType type)
{
  writeNpy(path, rowsOf(distributions, width), width, distributions.classes(),
           distributions.matrix().data(), type);
}

void
writeLabelIds(const std::string& path, const LabelDistributions& distributions,
              int width)
{
  cv::Mat ids(rowsOf(distributions, width), width, CV_8UC1);
  for (Eigen::Index j = 0; j < distributions.size(); ++j)
    ids.data[j] = distributions.mapLabel(j);
  writePng(path, ids);
}

} // namespace pcl_semantic
