// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/position_steps.h>

#include "core/text_stream.h"
#include "point_spacing.h"

#include <pcl/common/point_tests.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr float kFine =
    1e-5f; // [m]; no scanner's points are a tenth of a millimetre apart

} // namespace

std::string
doubtOfSteps(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, const std::string& name)
{
  std::vector<float> distances; // the largest coordinate of each point
  for (const pcl::PointXYZRGBL& point : cloud)
    if (pcl::isXYZFinite(point))
      distances.push_back(point.getArray3fMap().abs().maxCoeff());
  if (distances.size() < 2)
    return "";
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const float far = *middle;
  const float step = std::nextafter(far, std::numeric_limits<float>::max()) - far;
  if (!(step > kFine))
    return "";
  Eigen::MatrixXf positions(3, Eigen::Index(distances.size()));
  Eigen::Index column = 0;
  for (const pcl::PointXYZRGBL& point : cloud)
    if (pcl::isXYZFinite(point))
      positions.col(column++) = point.getVector3fMap();
  const Eigen::Vector3f first = positions.col(0);
  positions.colwise() -= first;
  const float spacing = pointSpacing(positions);
  if (step <= 0.1f * spacing)
    return "";
  TextStream text;
  text << name << ": single precision has steps of " << step << " m at " << far
       << " m, and its points are ";
  if (spacing > 0.0f)
    text << "about " << spacing << " m apart";
  else
    text << "mostly on one another";
  text << ": positions are lost; store x y z as doubles, or take an origin off first";
  return text.str();
}

} // namespace pcl_semantic
