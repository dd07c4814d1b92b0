// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface.h"

#include <memory>

namespace pcl_semantic {

/** \brief The classes of `data/label_sets/nyu13.yaml`, which the room uses. */
enum RoomClass : Label {
  room_bed = 1,
  room_books,
  room_ceiling,
  room_chair,
  room_floor,
  room_furniture,
  room_objects,
  room_picture,
  room_sofa,
  room_table,
  room_tv,
  room_wall,
  room_window,
  room_classes = 13 ///< number of classes
};

/** \brief A procedural furnished room: floor, ceiling, four walls, table and chairs,
 * shelves with books, a wardrobe, a bed, a sofa, pictures, a window, small objects.
 *
 * World frame: z up, origin on the floor in the middle of the room. The camera makes
 * one turn about the middle and looks across the room. The same seed gives the same
 * room. */
class SyntheticRoom {
public:
  static constexpr double seconds_per_frame = 0.1;

  /** \param[in] frames of one turn of the camera
   * \throws InvalidParameterException unless 1 <= frames <= 100000 */
  explicit SyntheticRoom(std::uint32_t seed, int frames = 40);

  std::uint32_t
  seed() const
  {
    return seed_;
  }

  int
  frames() const
  {
    return frames_;
  }

  /** \brief T_world_camera of a frame; camera axes: x right, y down, z forward.
   * \throws InvalidParameterException unless 0 <= frame < frames() */
  Eigen::Isometry3d pose(int frame) const;

  /** \brief Finds the first surface along a ray, up to 100 m.
   * \return false if there is none, outside the room */
  bool nearest(const synthetic::Ray& ray, synthetic::Surface& surface) const;

  /** \brief Fraction of the lamp's light that reaches a surface: 0 in the shadow. */
  double lampLight(const synthetic::Surface& surface) const;

private:
  std::uint32_t seed_;
  int frames_;
  Eigen::Vector3d lamp_; ///< world frame [m]
  std::shared_ptr<const synthetic::BoxTree> solids_;
};

} // namespace pcl_semantic
