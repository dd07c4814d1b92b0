// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "synthetic_shapes.h"

#include <vector>

namespace pcl_semantic::synthetic {

/** \brief Primitives in a binary tree of bounding boxes, for finding what a ray meets.
 */
class BoxTree {
public:
  explicit BoxTree(std::vector<Primitive> primitives);

  /** \brief The first primitive that a ray enters before \a distance.
   * \return null if there is none; \a distance and \a normal as intersect() */
  const Primitive* nearest(const Ray& ray, double& distance,
                           Eigen::Vector3d& normal) const;

  /** \brief Whether anything lies within \a distance along a ray. */
  bool blocked(const Ray& ray, double distance) const;

private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0; ///< first primitive of a leaf, right child otherwise
    int count = 0; ///< primitives of a leaf, 0 otherwise; the left child is next
    int axis = 0;  ///< along which the children lie
  };

  void build(int first, int last);

  template <typename Visit>
  void visit(const Ray& ray, double& distance, const Visit& leaf) const;

  std::vector<Primitive> primitives_;
  std::vector<Node> nodes_;
};

} // namespace pcl_semantic::synthetic
