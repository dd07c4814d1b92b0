// SPDX-License-Identifier: BSD-3-Clause
#include "shapes.h"

#include "noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic::synthetic {

namespace {

using Eigen::Vector3d;

constexpr double kNear = 1e-4; // nearer entries are the ray's own surface

bool
intersectBox(const Primitive& box, const Ray& ray, double& distance, Vector3d& normal)
{
  // Sides lean inward by taper / height: |x| + lean * z <= half - taper / 2.
  const Eigen::Vector2d lean = box.taper / (2.0 * box.half.z());
  double enter = -std::numeric_limits<double>::infinity();
  double leave = distance;
  for (int plane = 0; plane < 6; ++plane) {
    const int axis = plane / 2;
    Vector3d n = Vector3d::Zero();
    n[axis] = plane % 2 ? 1.0 : -1.0;
    double offset = box.half[axis];
    if (axis < 2) {
      n.z() = lean[axis];
      offset -= 0.5 * box.taper[axis];
    }
    const double speed = n.dot(ray.direction);
    const double gap = offset - n.dot(ray.origin);
    if (speed == 0.0) {
      if (gap < 0.0)
        return false;
      continue;
    }
    const double t = gap / speed;
    if (speed > 0.0)
      leave = std::min(leave, t);
    else if (t > enter) {
      enter = t;
      normal = n;
    }
  }
  if (enter < kNear || enter >= leave)
    return false;
  normal.normalize();
  distance = enter;
  return true;
}

/** \brief First root of a t^2 + 2 b t + c = 0. */
bool
firstRoot(double a, double b, double c, double& root)
{
  const double discriminant = b * b - a * c;
  if (discriminant <= 0.0 || a == 0.0)
    return false;
  root = (-b - std::sqrt(discriminant)) / a;
  return true;
}

bool
intersectCylinder(const Primitive& body, const Ray& ray, double& distance, Vector3d& n)
{
  const Eigen::Vector2d o = ray.origin.head<2>();
  const Eigen::Vector2d d = ray.direction.head<2>();
  double t = 0.0;
  const double square = body.half.x() * body.half.x();
  if (!firstRoot(d.squaredNorm(), o.dot(d), o.squaredNorm() - square, t))
    return false;
  const Vector3d p = ray.origin + t * ray.direction;
  if (t < kNear || t >= distance || std::abs(p.z()) > body.half.z())
    return false;
  n = Vector3d(p.x(), p.y(), 0.0) / body.half.x();
  distance = t;
  return true;
}

bool
intersectEllipsoid(const Primitive& body, const Ray& ray, double& distance, Vector3d& n)
{
  const Vector3d o = ray.origin.cwiseQuotient(body.half);
  const Vector3d d = ray.direction.cwiseQuotient(body.half);
  double t = 0.0;
  if (!firstRoot(d.squaredNorm(), o.dot(d), o.squaredNorm() - 1.0, t) || t < kNear ||
      t >= distance)
    return false;
  n = (o + t * d).cwiseQuotient(body.half).normalized();
  distance = t;
  return true;
}

/** \brief Negative inside a bush; roughly the distance relative to the half extents. */
double
bushFunction(const Primitive& bush, const Vector3d& p)
{
  const Vector3d q = p.cwiseQuotient(bush.half);
  double radius = q.norm();
  if (bush.square)
    radius = std::sqrt(std::sqrt(q.cwiseAbs2().squaredNorm()));
  const double gap = radius - 1.0;
  if (std::abs(gap) > bush.reach())
    return gap;
  const double wavelength = bush.square ? 0.7 : 0.8 * bush.half.minCoeff();
  const double swelling = bush.roughness * fractalNoise(p, wavelength, bush.id);
  return gap - std::clamp(swelling, -bush.reach(), bush.reach());
}

Vector3d
bushNormal(const Primitive& bush, const Vector3d& p)
{
  constexpr double step = 0.03;
  const double centre = bushFunction(bush, p);
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis)
    gradient[axis] = bushFunction(bush, p + step * Vector3d::Unit(axis)) - centre;
  return gradient.normalized();
}

/** \brief Fraction of the way from outside to inside a bush at which its surface lies:
 * both cameras must see the same surface. */
double
bushSurface(const Primitive& bush, const Ray& ray, double outside, double inside)
{
  for (int k = 0; k < 10; ++k) {
    const double middle = 0.5 * (outside + inside);
    const bool is_inside =
        bushFunction(bush, ray.origin + middle * ray.direction) < 0.0;
    (is_inside ? inside : outside) = middle;
  }
  return inside;
}

bool
intersectBush(const Primitive& bush, const Ray& ray, double& distance, Vector3d* normal)
{
  Primitive hull = bush;
  hull.half *= 1.0 + bush.reach();
  double begin = distance;
  Vector3d unused;
  if (!(bush.square ? intersectBox(hull, ray, begin, unused)
                    : intersectEllipsoid(hull, ray, begin, unused)))
    return false;
  const double smallest = bush.half.minCoeff() / ray.direction.norm();
  const double end =
      std::min(distance, begin + 2.5 * hull.half.norm() / ray.direction.norm());
  double before = begin;
  for (double t = begin; before < end;) {
    const double value = bushFunction(bush, ray.origin + t * ray.direction);
    if (value < 0.0) {
      if (normal || t >= distance)
        t = bushSurface(bush, ray, before, t);
      if (t >= distance)
        return false;
      if (normal)
        *normal = bushNormal(bush, ray.origin + t * ray.direction);
      distance = t;
      return true;
    }
    if (value > bush.reach() + 0.05 && t > begin + smallest)
      return false; // outside the hull
    before = t;
    t += smallest * std::max(0.7 * value, 0.08);
  }
  return false;
}

} // namespace

Eigen::AlignedBox3d
Primitive::bounds() const
{
  Vector3d size = half * (1.0 + reach());
  size.head<2>() -= taper.cwiseMin(0.0); // wider at the top
  const double c = std::abs(cosine);
  const double s = std::abs(sine);
  const Vector3d extent(c * size.x() + s * size.y(), s * size.x() + c * size.y(),
                        size.z());
  return {centre - extent, centre + extent};
}

bool
intersect(const Primitive& primitive, const Ray& ray, double& distance,
          Vector3d* normal)
{
  const Ray local{primitive.toLocal(ray.origin - primitive.centre),
                  primitive.toLocal(ray.direction)};
  Vector3d unused;
  Vector3d& wanted = normal ? *normal : unused;
  switch (primitive.shape) {
  case Shape::box:
    return intersectBox(primitive, local, distance, wanted);
  case Shape::cylinder:
    return intersectCylinder(primitive, local, distance, wanted);
  case Shape::ellipsoid:
    return intersectEllipsoid(primitive, local, distance, wanted);
  case Shape::bush:
    return intersectBush(primitive, local, distance, normal);
  }
  return false;
}

namespace {

bool
meets(const Eigen::AlignedBox3d& box, const Ray& ray, const Eigen::Vector3d& inverse,
      double distance)
{
  const Eigen::Vector3d a = (box.min() - ray.origin).cwiseProduct(inverse);
  const Eigen::Vector3d b = (box.max() - ray.origin).cwiseProduct(inverse);
  const double enter = std::max(a.cwiseMin(b).maxCoeff(), 0.0);
  return enter <= std::min(a.cwiseMax(b).minCoeff(), distance);
}

} // namespace

BoxTree::BoxTree(std::vector<Primitive> primitives) : primitives_(std::move(primitives))
{
  nodes_.reserve(2 * primitives_.size());
  if (!primitives_.empty())
    build(0, static_cast<int>(primitives_.size()));
}

void
BoxTree::build(int first, int last)
{
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d centres;
  for (int i = first; i < last; ++i) {
    box.extend(primitives_[i].bounds());
    centres.extend(primitives_[i].centre);
  }
  nodes_[node].box = box;
  if (last - first <= 2) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  int axis = 0;
  centres.sizes().maxCoeff(&axis);
  nodes_[node].axis = axis;
  const int middle = (first + last) / 2;
  std::sort(primitives_.begin() + first, primitives_.begin() + last,
            [axis](const Primitive& a, const Primitive& b) {
              return std::make_pair(a.centre[axis], a.id) <
                     std::make_pair(b.centre[axis], b.id);
            });
  build(first, middle);
  nodes_[node].first = static_cast<int>(nodes_.size());
  build(middle, last);
}

template <typename Visit>
void
BoxTree::visit(const Ray& ray, double& distance, const Visit& leaf) const
{
  // No component may be exactly zero, because 0 * infinity is NaN.
  const Eigen::Vector3d inverse = ray.direction.unaryExpr(
      [](double d) { return std::abs(d) < 1e-12 ? 1e12 : 1.0 / d; });
  int stack[64];
  int depth = 0;
  if (!nodes_.empty())
    stack[depth++] = 0;
  while (depth > 0) {
    const int index = stack[--depth];
    const Node& node = nodes_[index];
    if (!meets(node.box, ray, inverse, distance))
      continue;
    for (int i = node.first; i < node.first + node.count; ++i)
      if (leaf(primitives_[i]))
        return;
    if (node.count == 0) { // visit the nearer child first
      const bool forward = ray.direction[node.axis] > 0.0;
      stack[depth++] = forward ? node.first : index + 1;
      stack[depth++] = forward ? index + 1 : node.first;
    }
  }
}

const Primitive*
BoxTree::nearest(const Ray& ray, double& distance, Eigen::Vector3d& normal) const
{
  const Primitive* found = nullptr;
  visit(ray, distance, [&](const Primitive& primitive) {
    Eigen::Vector3d candidate;
    if (intersect(primitive, ray, distance, &candidate)) {
      found = &primitive;
      normal = candidate;
    }
    return false;
  });
  return found;
}

bool
BoxTree::blocked(const Ray& ray, double distance) const
{
  bool found = false;
  visit(ray, distance, [&](const Primitive& primitive) {
    double limit = distance;
    return found = intersect(primitive, ray, limit, nullptr);
  });
  return found;
}

} // namespace pcl_semantic::synthetic
