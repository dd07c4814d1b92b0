// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/object_summary.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcl_semantic {

namespace {

double
cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
  return a.x() * b.y() - a.y() * b.x();
}

bool
isLeftOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
  return std::make_pair(a.x(), a.y()) < std::make_pair(b.x(), b.y());
}

// Convex hull, counterclockwise (Andrew's monotone chain).
std::vector<Eigen::Vector2d>
convexHull(std::vector<Eigen::Vector2d> points)
{
  std::sort(points.begin(), points.end(), isLeftOf);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3)
    return points;
  std::vector<Eigen::Vector2d> hull;
  const auto addChain = [&](auto first, auto last) {
    const std::size_t begin = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= begin + 2 &&
             cross(hull.back() - hull[hull.size() - 2], *first - hull.back()) <= 0.0)
        hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back(); // the first of the other chain
  };
  addChain(points.begin(), points.end());
  addChain(points.rbegin(), points.rend());
  return hull;
}

} // namespace

const std::array<std::pair<std::size_t, std::size_t>, 12> YawBox::edges{{{0, 1},
                                                                         {1, 2},
                                                                         {2, 3},
                                                                         {3, 0},
                                                                         {4, 5},
                                                                         {5, 6},
                                                                         {6, 7},
                                                                         {7, 4},
                                                                         {0, 4},
                                                                         {1, 5},
                                                                         {2, 6},
                                                                         {3, 7}}};

std::vector<Eigen::Vector3d>
YawBox::corners() const
{
  const Eigen::Vector3d along(std::cos(yaw), std::sin(yaw), 0.0);
  const Eigen::Vector3d left(-along.y(), along.x(), 0.0);
  std::vector<Eigen::Vector3d> result;
  for (const double up : {-0.5, 0.5})
    for (const auto& [x, y] : {std::pair(-0.5, -0.5), std::pair(0.5, -0.5),
                               std::pair(0.5, 0.5), std::pair(-0.5, 0.5)})
      result.push_back(centre + x * size.x() * along + y * size.y() * left +
                       up * size.z() * Eigen::Vector3d::UnitZ());
  return result;
}

YawBox
smallestBox(const std::vector<Eigen::Vector3d>& points)
{
  std::vector<Eigen::Vector2d> flat;
  Eigen::AlignedBox1d heights;
  for (const Eigen::Vector3d& point : points) {
    flat.push_back(point.head<2>());
    heights.extend(point.tail<1>());
  }
  const std::vector<Eigen::Vector2d> hull = convexHull(std::move(flat));
  YawBox best;
  double best_area = HUGE_VAL;
  // The smallest rectangle has a side on an edge of the hull.
  for (std::size_t i = 0; i < hull.size(); ++i) {
    Eigen::Vector2d along = hull[(i + 1) % hull.size()] - hull[i];
    along = along.isZero() ? Eigen::Vector2d::UnitX() : along.normalized();
    const Eigen::Vector2d left(-along.y(), along.x());
    Eigen::AlignedBox2d extent;
    for (const Eigen::Vector2d& corner : hull)
      extent.extend(Eigen::Vector2d(along.dot(corner), left.dot(corner)));
    const Eigen::Vector2d sizes = extent.sizes(), middle = extent.center();
    if (!(sizes.prod() < best_area))
      continue;
    best_area = sizes.prod();
    best.centre << middle.x() * along + middle.y() * left, heights.center();
    const bool is_long = sizes.x() >= sizes.y();
    best.size << sizes.maxCoeff(), sizes.minCoeff(), heights.sizes();
    const Eigen::Vector2d axis = is_long ? along : left;
    // A box has no front.
    best.yaw = std::atan2(axis.y(), axis.x());
    best.yaw -= M_PI * std::round(best.yaw / M_PI);
  }
  return best;
}

ObjectSummary
summarizeObject(const std::vector<Eigen::Vector3d>& points)
{
  ObjectSummary summary;
  summary.points = points.size();
  for (const Eigen::Vector3d& point : points) {
    summary.centre += point / double(points.size());
    summary.box.extend(point);
  }
  summary.yaw_box = smallestBox(points);
  return summary;
}

ObjectSummary
summarizeObject(const pcl::Indices& indices,
                const std::function<Eigen::Vector3d(std::size_t)>& position,
                const LabelDistributions& distributions)
{
  std::vector<Eigen::Vector3d> points;
  Eigen::VectorXf sum = Eigen::VectorXf::Zero(distributions.classes());
  for (const pcl::index_t i : indices) {
    points.push_back(position(std::size_t(i)));
    if (!distributions.empty())
      sum += distributions.matrix().col(i);
  }
  ObjectSummary summary = summarizeObject(points);
  sum /= float(points.size());
  summary.probabilities.assign(sum.data(), sum.data() + sum.size());
  return summary;
}

} // namespace pcl_semantic
