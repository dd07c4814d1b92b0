// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/local_origin.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr double kFarAway = 1024.0; // [m]; single precision has steps of 1.2e-4 m
                                    // beyond
constexpr double kBesideGrids = 0.28125;

} // namespace

Eigen::Vector3d
localOrigin(const Eigen::Ref<const Eigen::Matrix3Xd>& positions)
{
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool is_far = false;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(std::size_t(positions.cols()));
    for (Eigen::Index i = 0; i < positions.cols(); ++i)
      if (std::isfinite(positions(axis, i)))
        values.push_back(positions(axis, i));
    if (values.empty())
      continue;
    is_far = is_far || std::any_of(values.begin(), values.end(), [](double value) {
               return std::abs(value) > kFarAway;
             });
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    origin[axis] = std::floor(*middle) + kBesideGrids;
  }
  return is_far ? origin : Eigen::Vector3d::Zero().eval();
}

Eigen::Matrix3Xf
relativeTo(const Eigen::Vector3d& origin,
           const Eigen::Ref<const Eigen::Matrix3Xd>& positions)
{
  Eigen::Matrix3Xf relative = (positions.colwise() - origin).cast<float>();
  const auto is_at_zero = (positions.array() == 0.0).colwise().all();
  if (is_at_zero.count() > 1)
    for (Eigen::Index i = 0; i < positions.cols(); ++i)
      if (is_at_zero(i))
        relative.col(i).setZero();
  return relative;
}

bool
isFarOff(const Eigen::Vector3f& relative)
{
  return relative.allFinite() && relative.cwiseAbs().maxCoeff() > float(kFarAway);
}

Eigen::Matrix3Xf
remaindersOf(const Eigen::Vector3d& origin,
             const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
             const Eigen::Matrix3Xf& relative)
{
  bool is_wide = false;
  for (Eigen::Index i = 0; i < relative.cols() && !is_wide; ++i)
    is_wide = isFarOff(relative.col(i));
  if (!is_wide)
    return {};
  Eigen::Matrix3Xf remainders = Eigen::Matrix3Xf::Zero(3, relative.cols());
  for (Eigen::Index i = 0; i < relative.cols(); ++i)
    if (relative.col(i).allFinite() && !relative.col(i).isZero(0.0f))
      remainders.col(i) =
          (positions.col(i) - origin - relative.col(i).cast<double>()).cast<float>();
  return remainders;
}

bool
areSingle(const Eigen::Ref<const Eigen::Matrix3Xd>& positions)
{
  return std::all_of(positions.data(), positions.data() + positions.size(),
                     [](double value) {
                       return double(float(value)) == value || !std::isfinite(value);
                     });
}

} // namespace pcl_semantic
