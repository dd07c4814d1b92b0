// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace pcl_semantic::synthetic {

/** \brief Look of a surface (materials.h). */
enum class Material : std::uint8_t {
  asphalt,
  paving,
  kerb,
  grass,
  wall,
  roof,
  boards,
  bark,
  leaves,
  car_body,
  car_cabin,
  tyre,
  metal,
  sign,
  cloth ///< its colour, with a fine grain
};

/** \brief Form of a primitive. */
enum class Shape : std::uint8_t {
  box,      ///< six planes; a taper makes wedges, cabins and gable roofs
  cylinder, ///< upright, round
  ellipsoid,
  bush ///< ellipsoid or rounded box with a surface displaced by noise
};

/** \brief A solid, rotated about the vertical. Objects of the street consist of
 * several. */
struct Primitive {
  Shape shape = Shape::box;
  Material material = Material::wall;
  Label label = kUnlabelled;
  std::uint32_t id = 0; ///< seeds texture and displacement
  int object = 0;       ///< number of the car or pedestrian; 0 = none
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< world frame [m]
  Eigen::Vector3d half = Eigen::Vector3d::Ones(); ///< half extents in its own axes [m]
  double cosine = 1.0;                            ///< of its heading
  double sine = 0.0;
  Eigen::Vector2d taper = Eigen::Vector2d::Zero(); ///< loss of half x, y at the top [m]
  double roughness = 0.0; ///< bush: displacement relative to the half extents
  bool square = false;    ///< bush: rounded box instead of an ellipsoid
  Eigen::Vector3f colour = Eigen::Vector3f::Constant(0.5f); ///< red, green, blue

  /** \brief Rotates a world vector to the primitive's axes. */
  Eigen::Vector3d
  toLocal(const Eigen::Vector3d& v) const
  {
    return {cosine * v.x() + sine * v.y(), cosine * v.y() - sine * v.x(), v.z()};
  }

  /** \brief Rotates a vector in the primitive's axes to the world's. */
  Eigen::Vector3d
  toWorld(const Eigen::Vector3d& v) const
  {
    return {cosine * v.x() - sine * v.y(), cosine * v.y() + sine * v.x(), v.z()};
  }

  /** \brief Largest displacement of a bush. Noise rarely reaches its limits, and a
   * tight hull saves most of the work. */
  double
  reach() const
  {
    return 0.7 * roughness;
  }

  /** \brief Box around the primitive, world axes. */
  Eigen::AlignedBox3d bounds() const;
};

/** \brief A half line origin + distance * direction, with a direction of any length. */
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
};

/** \brief Finds the point where a ray enters a primitive.
 * \param[in,out] distance in multiples of the ray's direction; only entries in front of
 * the origin and before its old value count
 * \param[out] normal outward, in the primitive's axes, length 1; null = not needed, and
 * then \a distance may be approximate
 * \return whether such a point exists */
bool intersect(const Primitive& primitive, const Ray& ray, double& distance,
               Eigen::Vector3d* normal);

/** \brief Primitives in a binary tree of bounding boxes, to intersect them with
 * rays. */
class BoxTree {
public:
  explicit BoxTree(std::vector<Primitive> primitives);

  /** \brief Finds the first primitive that a ray enters before \a distance.
   * \return null if none exists; \a distance and \a normal as for intersect() */
  const Primitive* nearest(const Ray& ray, double& distance,
                           Eigen::Vector3d& normal) const;

  /** \brief Whether a primitive is within \a distance along a ray. */
  bool blocked(const Ray& ray, double distance) const;

  const std::vector<Primitive>&
  primitives() const
  {
    return primitives_;
  }

private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0; ///< first primitive of a leaf, right child otherwise
    int count = 0; ///< primitives of a leaf, 0 otherwise; the left child is next
    int axis = 0;  ///< axis that separates the children
  };

  void build(int first, int last);

  template <typename Visit>
  void visit(const Ray& ray, double& distance, const Visit& leaf) const;

  std::vector<Primitive> primitives_;
  std::vector<Node> nodes_;
};

} // namespace pcl_semantic::synthetic
