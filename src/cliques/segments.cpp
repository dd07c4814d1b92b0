// SPDX-License-Identifier: BSD-3-Clause
#include "segments.h"

#include <pcl_semantic/cliques/slic.h>

#include <cstdint>
#include <limits>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr int kNone = -1;

// A connected part of the image, with what has joined it.
struct Part {
  std::size_t first = 0;                    // its pixels' place in the list of all
  std::size_t end = 0;                      // and their end
  int joined = kNone;                       // has joined this part
  std::int64_t pixels = 0;                  // sums over it and what has joined it
  cv::Vec<std::int64_t, 3> colour{0, 0, 0}; // likewise
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

// The parts of an image, in the order of their first pixels, and who joins whom.
class Parts {
public:
  Parts(const cv::Mat& labels, const cv::Mat& image)
      : numbers_(labels.size(), CV_32SC1, cv::Scalar(kNone))
  {
    for (int v = 0; v < labels.rows; ++v)
      for (int u = 0; u < labels.cols; ++u)
        if (numbers_.at<int>(v, u) == kNone)
          fill({u, v}, labels, image);
  }

  void
  joinSmall(std::size_t smallest)
  {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const int root = rootOf(int(i));
      Part& part = parts_[std::size_t(root)];
      if (std::size_t(part.pixels) >= smallest)
        continue;
      const int neighbour = nearestNeighbour(parts_[i], root, smallest);
      if (neighbour == kNone)
        continue;
      part.joined = neighbour;
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
        int& number = final_numbers[std::size_t(rootOf(numbers_.at<int>(v, u)))];
        if (number == kNone)
          number = next++;
        result.at<int>(v, u) = number;
      }
    return result;
  }

private:
  // A part of the pixels connected to `start` that share its label.
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

  int
  rootOf(int part)
  {
    int root = part;
    while (parts_[std::size_t(root)].joined != kNone)
      root = parts_[std::size_t(root)].joined;
    while (part != root) // the next search is short
      part = std::exchange(parts_[std::size_t(part)].joined, root);
    return root;
  }

  // Of the parts beside the pixels of `part`, which has come to belong to `root`.
  int
  nearestNeighbour(const Part& part, int root, std::size_t smallest)
  {
    int nearest = kNone;
    std::pair<bool, double> least(true, std::numeric_limits<double>::infinity());
    const auto compare = [&](cv::Point pixel) {
      const int other = rootOf(numbers_.at<int>(pixel));
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
  std::vector<cv::Point> pixels_; // part by part
  cv::Mat numbers_;               // CV_32SC1: the part of every pixel
};

} // namespace

cv::Mat
connectedSegments(const cv::Mat& labels, const cv::Mat& image, std::size_t smallest)
{
  Parts parts(labels, image);
  parts.joinSmall(smallest);
  return parts.segments();
}

std::vector<pcl::PointIndices>
cliquesOfSegments(const cv::Mat& segments)
{
  std::vector<pcl::PointIndices> cliques;
  for (int v = 0; v < segments.rows; ++v)
    for (int u = 0; u < segments.cols; ++u) {
      const auto segment = static_cast<std::size_t>(segments.at<int>(v, u));
      if (segment >= cliques.size())
        cliques.resize(segment + 1);
      cliques[segment].indices.push_back(v * segments.cols + u);
    }
  return cliques;
}

} // namespace pcl_semantic
