// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/position_steps.h>

#include "core/text_stream.h"
#include "point_spacing.h"

#include <pcl/common/point_tests.h>

#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr float kFine =
    1e-5f; // [m]; no scanner's points are a tenth of a millimetre apart

} // namespace

std::string
doubtOfSteps(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, const std::string& name)
{
  float farthest = 0.0f;
  Eigen::Index count = 0;
  for (const pcl::PointXYZRGBL& point : cloud)
    if (pcl::isXYZFinite(point)) {
      farthest = std::max(farthest, point.getArray3fMap().abs().maxCoeff());
      ++count;
    }
  const float step =
      std::nextafter(farthest, std::numeric_limits<float>::max()) - farthest;
  if (!(step > kFine) || count < 2)
    return "";
  Eigen::MatrixXf positions(3, count);
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
  text << name << ": single precision has steps of " << step << " m at " << farthest
       << " m, and its points are ";
  if (spacing > 0.0f)
    text << "about " << spacing << " m apart";
  else
    text << "mostly on one another";
  text << ": positions are lost; store x y z as doubles, or take an origin off first";
  return text.str();
}

} // namespace pcl_semantic
