// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/slic_assignment.h"
#include "segments.h"

#include <pcl_semantic/cliques/slic.h>
#include <pcl_semantic/core/exceptions.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

template <typename T>
void
require(bool valid, const char* name, T value, const char* expected)
{
  if (!valid)
    PCL_THROW_EXCEPTION(InvalidParameterException, "SLIC: " << name << " is " << value
                                                            << ", expected "
                                                            << expected);
}

// An image of channels that the clustering compares, 0..255 each.
struct LabImage {
  cv::Mat bytes;                 // CV_8UC3
  std::array<cv::Mat, 3> planes; // CV_32FC1
};

LabImage
smallLabImage(const cv::Mat& image, int downscale)
{
  cv::Mat small = image;
  if (downscale > 1)
    cv::resize(image, small,
               cv::Size((image.cols + downscale - 1) / downscale,
                        (image.rows + downscale - 1) / downscale),
               0.0, 0.0, cv::INTER_AREA);
  if (small.channels() == 1)
    cv::cvtColor(small, small, cv::COLOR_GRAY2BGR);
  LabImage lab;
  cv::cvtColor(small, lab.bytes, cv::COLOR_BGR2Lab);
  cv::Mat floats;
  lab.bytes.convertTo(floats, CV_32F);
  cv::split(floats, lab.planes.data());
  return lab;
}

// Centres on a regular grid, and every pixel in the cell it lies in.
std::vector<SlicCentre>
gridCentres(const LabImage& lab, int superpixels, cv::Mat& labels)
{
  const int width = lab.bytes.cols, height = lab.bytes.rows;
  const double spacing = std::sqrt(double(width) * height / superpixels);
  const int columns = std::clamp(int(std::lround(width / spacing)), 1, width);
  const int rows = std::clamp(int(std::lround(height / spacing)), 1, height);
  labels.create(height, width, CV_32SC1);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      labels.at<int>(v, u) = int(std::int64_t(v) * rows / height) * columns +
                             int(std::int64_t(u) * columns / width);
  return std::vector<SlicCentre>(std::size_t(rows) * std::size_t(columns));
}

struct SlicSum {
  std::int64_t l = 0, a = 0, b = 0, x = 0, y = 0, count = 0;

  SlicSum&
  operator+=(const SlicSum& other)
  {
    l += other.l;
    a += other.a;
    b += other.b;
    x += other.x;
    y += other.y;
    count += other.count;
    return *this;
  }
};

// Whole numbers: their sums do not depend on who adds them up.
std::vector<SlicSum>
sumPixels(const LabImage& lab, const cv::Mat& labels, std::size_t centres)
{
  std::vector<SlicSum> sums(centres);
#pragma omp parallel
  {
    std::vector<SlicSum> part(centres);
#pragma omp for schedule(static)
    for (int v = 0; v < labels.rows; ++v) {
      const cv::Vec3b* const pixels = lab.bytes.ptr<cv::Vec3b>(v);
      const int* const row = labels.ptr<int>(v);
      for (int u = 0; u < labels.cols; ++u) {
        SlicSum& sum = part[std::size_t(row[u])];
        sum.l += pixels[u][0];
        sum.a += pixels[u][1];
        sum.b += pixels[u][2];
        sum.x += u;
        sum.y += v;
        ++sum.count;
      }
    }
#pragma omp critical
    for (std::size_t c = 0; c < centres; ++c)
      sums[c] += part[c];
  }
  return sums;
}

// Moves every centre to the mean of its pixels; one that has lost all of them stays.
void
moveCentres(const LabImage& lab, const cv::Mat& labels,
            std::vector<SlicCentre>& centres)
{
  const std::vector<SlicSum> sums = sumPixels(lab, labels, centres.size());
  for (std::size_t c = 0; c < centres.size(); ++c)
    if (const SlicSum& sum = sums[c]; sum.count > 0) {
      const auto mean = [&](std::int64_t total) {
        return float(double(total) / double(sum.count));
      };
      centres[c] = {mean(sum.l), mean(sum.a), mean(sum.b), mean(sum.x), mean(sum.y)};
    }
}

// Gives every pixel the nearest centre; one that no centre reaches keeps what it has.
void
assignPixels(const LabImage& lab, const std::vector<SlicCentre>& centres, float reach,
             float spatial_weight, cv::Mat& labels)
{
  const AssignSlicRow assign = slicAssignment(simdTier());
  cv::Mat distances(labels.size(), CV_32FC1);
#pragma omp parallel for schedule(static)
  for (int v = 0; v < labels.rows; ++v) {
    SlicRow row;
    for (int channel = 0; channel < 3; ++channel)
      row.lab[channel] = lab.planes[std::size_t(channel)].ptr<float>(v);
    row.distances = distances.ptr<float>(v);
    row.labels = labels.ptr<int>(v);
    row.width = labels.cols;
    row.y = float(v);
    std::fill_n(row.distances, row.width, std::numeric_limits<float>::infinity());
    for (std::size_t c = 0; c < centres.size(); ++c)
      if (const SlicCentre& centre = centres[c]; std::abs(centre.y - row.y) < reach)
        assign(row, centre, int(c), std::max(0, int(std::ceil(centre.x - reach))),
               std::min(row.width, int(centre.x + reach) + 1), spatial_weight);
  }
}

// Nearest neighbours: numbers have no mean.
cv::Mat
enlarge(const cv::Mat& segments, cv::Size size)
{
  if (segments.size() == size)
    return segments;
  cv::Mat large(size, CV_32SC1);
  std::vector<int> columns(std::size_t(size.width));
  for (int u = 0; u < size.width; ++u)
    columns[std::size_t(u)] = int(std::int64_t(u) * segments.cols / size.width);
  for (int v = 0; v < size.height; ++v) {
    const int* const from =
        segments.ptr<int>(int(std::int64_t(v) * segments.rows / size.height));
    int* const to = large.ptr<int>(v);
    for (int u = 0; u < size.width; ++u)
      to[u] = from[columns[std::size_t(u)]];
  }
  return large;
}

} // namespace

void
SlicParameters::validate() const
{
  require(superpixels >= 1 && superpixels <= 65536, "superpixels", superpixels,
          "1 to 65536");
  require(compactness > 0.0 && compactness <= 1000.0, "compactness", compactness,
          "a positive number up to 1000");
  require(iterations >= 1 && iterations <= 100, "iterations", iterations, "1 to 100");
  require(downscale >= 1 && downscale <= 16, "downscale", downscale, "1 to 16");
}

cv::Mat
slicSuperpixels(const cv::Mat& image, const SlicParameters& parameters)
{
  parameters.validate();
  if (image.empty() || (image.type() != CV_8UC3 && image.type() != CV_8UC1))
    PCL_THROW_EXCEPTION(BadInputException,
                        "SLIC: expected an image of 8-bit grey or 8-bit colour");
  const LabImage lab = smallLabImage(image, parameters.downscale);
  cv::Mat labels;
  std::vector<SlicCentre> centres = gridCentres(lab, parameters.superpixels, labels);
  const double spacing = std::sqrt(double(labels.total()) / double(centres.size()));
  const double ratio = parameters.compactness / spacing;
  moveCentres(lab, labels, centres);
  for (int i = 0; i < parameters.iterations; ++i) {
    assignPixels(lab, centres, float(spacing), float(ratio * ratio), labels);
    moveCentres(lab, labels, centres);
  }
  const std::size_t smallest = labels.total() / centres.size() / 4;
  return enlarge(connectedSegments(labels, lab.bytes, smallest), image.size());
}

} // namespace pcl_semantic
