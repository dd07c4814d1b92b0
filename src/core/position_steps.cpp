// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/position_steps.h>

#include "point_spacing.h"
#include "text_stream.h"

#include <pcl/console/print.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr float kFine = 1e-5f; // [m]; no scanner resolves a tenth of a millimetre

} // namespace

std::string
doubtOfSteps(const Eigen::Matrix3Xf& positions, const Eigen::Vector3d& origin,
             const std::string& name)
{
  std::vector<Eigen::Index> measured;
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    if (positions.col(i).allFinite())
      measured.push_back(i);
  if (measured.size() < 5) // too few for a spacing
    return "";
  std::vector<float> distances; // largest absolute coordinate of each point
  for (const Eigen::Index i : measured)
    distances.push_back(
        float((positions.col(i).cast<double>() + origin).lpNorm<Eigen::Infinity>()));
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const float far = *middle;
  const float step = std::nextafter(far, std::numeric_limits<float>::max()) - far;
  if (!(step > kFine))
    return "";
  Eigen::MatrixXf beside(3, Eigen::Index(measured.size()));
  for (Eigen::Index i = 0; i < beside.cols(); ++i)
    beside.col(i) =
        positions.col(measured[std::size_t(i)]) - positions.col(measured[0]);
  const float spacing = pointSpacing(beside);
  if (step <= 0.1f * spacing)
    return "";
  TextStream text;
  text << name << ": single precision has steps of " << step << " m at " << far
       << " m, and its points are ";
  if (spacing > 0.0f)
    text << "about " << spacing << " m apart";
  else
    text << "mostly at equal positions";
  text
      << ": positions are rounded; store x y z as doubles, or subtract an origin first";
  return text.str();
}

void
warnOfDoubt(const std::string& filter, const std::string& doubt)
{
  if (!doubt.empty())
    PCL_WARN("[pcl_semantic::%s] %s\n", filter.c_str(), doubt.c_str());
}

} // namespace pcl_semantic
