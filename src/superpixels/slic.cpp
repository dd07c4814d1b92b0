// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/superpixels/slic.h>

#include "core/disjoint_sets.h"
#include "core/fail.h"
#include "kernels/slic_assignment.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <omp.h>

namespace pcl_semantic {

namespace {

constexpr int kNone = -1;

// A connected part of the image and the parts merged into it.
struct Part {
  std::size_t first = 0;                    // range of its pixels in the list of all
  std::size_t end = 0;                      // and their end
  std::int64_t pixels = 0;                  // sum, including merged parts
  cv::Vec<std::int64_t, 3> colour{0, 0, 0}; // sum, including merged parts
};

double
colourDistance(const Part& a, const Part& b)
{
  double sum = 0.0;
  for (int channel = 0; channel < 3; ++channel) {
    const double difference = double(a.colour[channel]) / double(a.pixels) -
                              double(b.colour[channel]) / double(b.pixels);
    sum += difference * difference;
  }
  return sum;
}

template <typename Visit>
void
visitNeighbours(const cv::Mat& image, cv::Point pixel, Visit&& visit)
{
  if (pixel.x > 0)
    visit(cv::Point(pixel.x - 1, pixel.y));
  if (pixel.x + 1 < image.cols)
    visit(cv::Point(pixel.x + 1, pixel.y));
  if (pixel.y > 0)
    visit(cv::Point(pixel.x, pixel.y - 1));
  if (pixel.y + 1 < image.rows)
    visit(cv::Point(pixel.x, pixel.y + 1));
}

// The parts of an image, in the order of their first pixels, with the state of merging.
class Parts {
public:
  Parts(const cv::Mat& labels, const cv::Mat& image)
      : numbers_(labels.size(), CV_32SC1, cv::Scalar(kNone))
  {
    for (int v = 0; v < labels.rows; ++v)
      for (int u = 0; u < labels.cols; ++u)
        if (numbers_.at<int>(v, u) == kNone)
          fill({u, v}, labels, image);
    sets_.grow(parts_.size());
  }

  void
  joinSmall(std::size_t smallest)
  {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const int root = sets_.rootOf(int(i));
      Part& part = parts_[std::size_t(root)];
      if (std::size_t(part.pixels) >= smallest)
        continue;
      const int neighbour = nearestNeighbour(parts_[i], root, smallest);
      if (neighbour == kNone)
        continue;
      sets_.join(root, neighbour);
      parts_[std::size_t(neighbour)].pixels += part.pixels;
      parts_[std::size_t(neighbour)].colour += part.colour;
    }
  }

  cv::Mat
  segments()
  {
    cv::Mat result(numbers_.size(), CV_32SC1);
    std::vector<int> final_numbers(parts_.size(), kNone);
    int next = 0;
    for (int v = 0; v < result.rows; ++v)
      for (int u = 0; u < result.cols; ++u) {
        int& number = final_numbers[std::size_t(sets_.rootOf(numbers_.at<int>(v, u)))];
        if (number == kNone)
          number = next++;
        result.at<int>(v, u) = number;
      }
    return result;
  }

private:
  // Flood-fills the pixels that are connected to `start` and share its label.
  void
  fill(cv::Point start, const cv::Mat& labels, const cv::Mat& image)
  {
    const int number = int(parts_.size()), label = labels.at<int>(start);
    Part part;
    part.first = pixels_.size();
    const auto take = [&](cv::Point pixel) {
      if (labels.at<int>(pixel) != label || numbers_.at<int>(pixel) != kNone)
        return;
      numbers_.at<int>(pixel) = number;
      pixels_.push_back(pixel);
      part.colour += image.at<cv::Vec3b>(pixel);
    };
    take(start);
    for (std::size_t i = part.first; i < pixels_.size(); ++i)
      visitNeighbours(labels, cv::Point(pixels_[i]), take);
    part.end = pixels_.size();
    part.pixels = std::int64_t(part.end - part.first);
    parts_.push_back(part);
  }

  // The neighbour of `part` with the closest colour; `root` is the part's current root.
  int
  nearestNeighbour(const Part& part, int root, std::size_t smallest)
  {
    int nearest = kNone;
    std::pair<bool, double> least(true, std::numeric_limits<double>::infinity());
    const auto compare = [&](cv::Point pixel) {
      const int other = sets_.rootOf(numbers_.at<int>(pixel));
      if (other == root || other == nearest)
        return;
      const Part& candidate = parts_[std::size_t(other)];
      const std::pair<bool, double> key(
          std::size_t(candidate.pixels) < smallest,
          colourDistance(parts_[std::size_t(root)], candidate));
      if (key < least) {
        least = key;
        nearest = other;
      }
    };
    for (std::size_t i = part.first; i < part.end; ++i)
      visitNeighbours(numbers_, pixels_[i], compare);
    return nearest;
  }

  std::vector<Part> parts_;
  DisjointSets sets_;             // of merged parts; the root has the sums
  std::vector<cv::Point> pixels_; // part by part
  cv::Mat numbers_;               // CV_32SC1: part of every pixel
};

/** \brief Splits labels (CV_32SC1) into 4-connected segments. A segment of fewer than
 * \a smallest pixels is merged with the neighbour of closest mean colour, preferably a
 * large one.
 * \param[in] image CV_8UC3
 * \return CV_32SC1: numbers 0, 1, ... in the order of the first pixels */
cv::Mat
connectedSegments(const cv::Mat& labels, const cv::Mat& image, std::size_t smallest)
{
  Parts parts(labels, image);
  parts.joinSmall(smallest);
  return parts.segments();
}

template <typename T>
void
require(bool valid, const char* name, T value, const char* expected)
{
  if (!valid)
    badParameter("SLIC: ", name, " is ", value, ", expected ", expected);
}

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

// Centres on a regular grid; every pixel starts with the centre of its cell.
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

using SlicSum = cv::Vec<std::int64_t, 6>; // l, a, b, x, y, and the number of pixels

// Integers: their sums do not depend on the order of the threads.
std::vector<SlicSum>
sumPixels(const LabImage& lab, const cv::Mat& labels, std::size_t centres)
{
  std::vector<SlicSum> sums(centres);
  std::vector<std::vector<SlicSum>> parts(std::size_t(omp_get_max_threads()), sums);
#pragma omp parallel
  {
    std::vector<SlicSum>& part = parts[std::size_t(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (int v = 0; v < labels.rows; ++v) {
      const cv::Vec3b* const pixels = lab.bytes.ptr<cv::Vec3b>(v);
      const int* const row = labels.ptr<int>(v);
      for (int u = 0; u < labels.cols; ++u) {
        const cv::Vec3b& lab_bytes = pixels[u];
        part[std::size_t(row[u])] +=
            SlicSum(lab_bytes[0], lab_bytes[1], lab_bytes[2], u, v, 1);
      }
    }
  }
  for (const std::vector<SlicSum>& part : parts)
    for (std::size_t c = 0; c < centres; ++c)
      sums[c] += part[c];
  return sums;
}

// Moves every centre to the mean of its pixels; an empty one stays.
void
moveCentres(const LabImage& lab, const cv::Mat& labels,
            std::vector<SlicCentre>& centres)
{
  const std::vector<SlicSum> sums = sumPixels(lab, labels, centres.size());
  for (std::size_t c = 0; c < centres.size(); ++c)
    if (const SlicSum& sum = sums[c]; sum[5] > 0) {
      const auto mean = [&](int i) { return float(double(sum[i]) / double(sum[5])); };
      centres[c] = {mean(0), mean(1), mean(2), mean(3), mean(4)};
    }
}

// Assigns every pixel to the nearest centre; without a centre in reach it keeps its
// label.
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

// Nearest neighbour, because labels cannot be averaged.
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
    badInput("SLIC: expected an image of 8-bit grey or 8-bit colour");
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

std::vector<pcl::PointIndices>
cliquesOfSegments(const cv::Mat& segments)
{
  if (!segments.empty() && segments.type() != CV_32SC1)
    badParameter("segments are 32-bit numbers of one channel");
  std::vector<pcl::PointIndices> cliques;
  for (int v = 0; v < segments.rows; ++v)
    for (int u = 0; u < segments.cols; ++u) {
      const int number = segments.at<int>(v, u);
      // There are at most as many segments as pixels.
      if (number < 0 || std::size_t(number) >= segments.total())
        badParameter("pixel (", u, ", ", v, ") has the segment ", number,
                     ", expected 0 to ", segments.total() - 1);
      const auto segment = std::size_t(number);
      if (segment >= cliques.size())
        cliques.resize(segment + 1);
      cliques[segment].indices.push_back(v * segments.cols + u);
    }
  return cliques;
}

} // namespace pcl_semantic
