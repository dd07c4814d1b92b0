// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "synthetic_road.h"
#include "synthetic_shapes.h"

#include <vector>

namespace pcl_semantic::synthetic {

/** \brief Adds the solids of one object after the other; an object has a place along
 * the road, a height of the ground under it and a heading. */
class ObjectBuilder {
public:
  explicit ObjectBuilder(std::uint32_t seed) : seed_(seed) {}

  /** \brief The next object stands here.
   * \param[in] turned heading relative to the road's [rad] */
  void place(const RoadLine& road, const RoadPoint& point, double turned = 0.0);

  /** \param[in] width along the street \param[in] depth across [m] */
  void house(double width, double depth, Random& random);

  void tree(double height, Random& random);

  /** \brief A hedge along the street. */
  void hedge(double length, double height);

  /** \brief A fence of boards along the street. */
  void fence(double length, double height, const Eigen::Vector3f& colour);

  void car(Random& random);

  /** \param[in] towards_road +1 if the road lies to the object's left, else -1 */
  void lampPost(double towards_road);

  void trafficSign(Random& random);

  void pedestrian(Random& random);

  std::vector<Primitive>
  take()
  {
    return std::move(primitives_);
  }

private:
  /** \brief Adds a solid of the object. \a bottom is the middle of its lower side,
   * the object's axes (x along, y left, z up from the ground) [m]. */
  Primitive& add(Shape shape, Material material, Label label,
                 const Eigen::Vector3d& bottom, const Eigen::Vector3d& size,
                 const Eigen::Vector3f& colour);

  std::uint32_t seed_;
  std::vector<Primitive> primitives_;
  Eigen::Vector3d ground_ = Eigen::Vector3d::Zero();
  double cosine_ = 1.0;
  double sine_ = 0.0;
  std::uint32_t object_ = 0; ///< names the object, wherever it stands in the list
  std::uint32_t parts_ = 0;
};

/** \brief Puts everything that stands along a road: houses and their fences, hedges and
 * trees, parked cars, lamp posts, signs, people.
 * \param[in] length how far along the road [m] */
std::vector<Primitive> buildStreet(const RoadLine& road, double length,
                                   std::uint32_t seed);

} // namespace pcl_semantic::synthetic
