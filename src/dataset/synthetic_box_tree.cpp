// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_box_tree.h"

#include <algorithm>

namespace pcl_semantic::synthetic {

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
  // No axis may be exactly zero: 0 * infinity is no number.
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
    if (node.count == 0) { // the nearer child is looked into first
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
