// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/images/image_crf.h>

#include "core/fail.h"
#include "filters/element_crf.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <map>
#include <numeric>

namespace pcl_semantic {

ImageCRF::ImageCRF()
{
  setParameters(SemanticCRFParameters::forImages());
}

void
ImageCRF::setCliques(const std::vector<pcl::PointIndices>& cliques)
{
  requireMembers(cliques);
  cliques_ = cliques;
  segments_width_ = segments_height_ = 0;
}

void
ImageCRF::setSegments(const cv::Mat& segments)
{
  const int type = segments.type();
  if (type != CV_8UC1 && type != CV_16UC1 && type != CV_32SC1)
    badParameter(
        "the image of segments has another type, expected one channel of integers");
  if (segments.empty())
    badParameter("the image of segments is empty");
  cv::Mat1i numbers;
  segments.convertTo(numbers, CV_32S);
  std::map<int, pcl::Indices> members;
  for (int y = 0; y < numbers.rows; ++y)
    for (int x = 0; x < numbers.cols; ++x) {
      const int number = numbers(y, x);
      if (number < 0)
        badParameter("pixel (", x, ", ", y, ") has the segment ", number,
                     ", expected 0 or more");
      if (number > 0)
        members[number].push_back(y * numbers.cols + x);
    }
  std::vector<pcl::PointIndices> cliques(members.size());
  auto clique = cliques.begin();
  for (auto& [number, indices] : members)
    (clique++)->indices = std::move(indices);
  setCliques(cliques);
  segments_width_ = segments.cols;
  segments_height_ = segments.rows;
}

LabelDistributions
ImageCRF::refine(const cv::Mat& image, const LabelDistributions& measured)
{
  if (image.type() != CV_8UC3 && image.type() != CV_8UC1)
    badParameter("the image has another type, expected CV_8UC3 or CV_8UC1");
  if (std::size_t(measured.size()) != image.total())
    badParameter("there are label distributions of ", measured.size(),
                 " pixels for an image of ", image.cols, " x ", image.rows);
  if (segments_width_ > 0 &&
      (segments_width_ != image.cols || segments_height_ != image.rows))
    badParameter("there are segments of ", segments_width_, " x ", segments_height_,
                 " pixels for an image of ", image.cols, " x ", image.rows);
  const Eigen::Index channels = image.channels(), width = image.cols;
  CRFElements elements;
  elements.total = image.total();
  elements.spacing = 1.0; // [px]
  elements.indices.resize(image.total());
  std::iota(elements.indices.begin(), elements.indices.end(), 0);
  elements.positions.resize(2, measured.size());
  elements.colours.resize(channels, measured.size());
#pragma omp parallel for schedule(static)
  for (int y = 0; y < image.rows; ++y)
    for (Eigen::Index x = 0; x < width; ++x) {
      elements.positions.col(y * width + x) << float(x), float(y);
      for (Eigen::Index c = 0; c < channels; ++c)
        elements.colours(c, y * width + x) = float(image.ptr(y)[x * channels + c]);
    }
  LabelDistributions result = measured;
  report_ = refineElements(terms_, cliques_ ? &*cliques_ : nullptr, elements, result);
  return result;
}

} // namespace pcl_semantic
