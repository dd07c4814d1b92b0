// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/things/object_summary.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The part of an object that one frame hit. */
struct ObjectSighting {
  int frame = 0;                                    ///< counted from 0
  double timestamp = 0.0;                           ///< [s]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< mean of the hits, world [m]
  Eigen::AlignedBox3d box;                          ///< of the hits, world frame [m]
  std::vector<VoxelIndex> voxels;                   ///< hit by the frame
};

/** \brief An object of a map, and what ObjectTracker needs to follow it. */
struct MapObject {
  std::uint32_t number = 0; ///< from 1
  Label label = kUnlabelled;
  ObjectTrack summary;                     ///< of its track
  std::vector<VoxelIndex> voxels;          ///< in the order z, y, x
  std::vector<std::uint32_t> observations; ///< of each voxel, in the last frame with
                                           ///< the voxel in the window
  int last_frame = 0;                      ///< last frame that hit it, from 0
  std::optional<int> last_moved;        ///< last frame with evidence of motion, from 0
  std::deque<ObjectSighting> sightings; ///< of the last frames
};

/** \brief The objects of a map, as ObjectTracker has left them. */
struct MapObjects {
  std::vector<MapObject> objects;       ///< ascending numbers
  std::vector<std::uint32_t> unchanged; ///< numbers of other objects, ascending, which
                                        ///< are as an archive has them already
  std::uint32_t last_number = 0;        ///< largest number so far, also of objects that
                                        ///< no longer exist
  int frames = 0;                       ///< number of frames so far
  std::size_t min_voxels = 1; ///< objects with fewer voxels have no number in clouds
};

/** \brief Finds the objects of voxels. */
class ObjectLookup {
public:
  /** \param[in] objects without unchanged ones */
  explicit ObjectLookup(MapObjects objects);

  /** \brief The number of the object of each voxel, 0 = none.
   * \param[in] voxels any voxels of the map */
  std::vector<std::uint32_t> numbers(const VoxelCloud& voxels) const;

  /** \brief Describes the objects of a cloud, see summarizeObjects().
   * \param[in] voxels with VoxelCloud::objects of numbers() */
  std::vector<ObjectSummary> summarize(const VoxelCloud& voxels) const;

private:
  MapObjects objects_;
  std::unordered_map<VoxelIndex, std::size_t, VoxelIndexHash> of_; // index in objects_
};

/** \brief Describes the objects of a cloud, in the order of their numbers, in the world
 * frame.
 * \param[in] voxels with VoxelCloud::objects
 * \param[in] object the object of a number */
std::vector<ObjectSummary>
summarizeObjects(const VoxelCloud& voxels,
                 const std::function<const MapObject&(std::uint32_t)>& object);

} // namespace pcl_semantic
