// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/frame_time.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/things/map_objects.h>
#include <pcl_semantic/things/object_extraction.h>
#include <pcl_semantic/things/object_summary.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Numbers the objects of a map, so that each keeps its number over the frames.
 *
 * After each frame, the objects of the map's window are extracted and matched with the
 * known ones by the voxels that they share. A still object consists of its voxels. An
 * object of a dynamic class moves if the voxels that frames saw of it are free a few
 * frames later. It is then matched where its motion predicts it, and its voxels are
 * where it is now. Objects out of the window keep their numbers and voxels. */
class ObjectTracker {
public:
  /** \brief Voxels from min() to max(), both inside. */
  using Window = Eigen::AlignedBox<int, 3>;

  struct Parameters {
    double gap = ObjectExtractionBase::default_gap; ///< see ObjectExtraction [m]
    int min_voxels = 20; ///< minimum number of voxels of an object

    /** \throws InvalidParameterException that names the parameter and its range */
    void validate() const;
  };

  /** \throws InvalidParameterException if a parameter is out of range, or no class of
   * the label set is marked `thing` */
  ObjectTracker(const LabelSet& label_set, const Parameters& parameters);

  ~ObjectTracker();

  /** \brief Finds the objects in the map after a frame.
   * \param[in] voxels the occupied voxels of the window
   * \param[in] window of the map
   * \throws BadInputException as connectedComponents() */
  void update(const VoxelCloud& voxels, const Window& window, const FrameTime& frame);

  /** \brief Finds the objects again, if labels of the map have changed since the last
   * update(). Nothing moves.
   * \param[in] voxels, window as in update() */
  void updateLabels(const VoxelCloud& voxels, const Window& window);

  /** \brief Voxels that moving objects have left in the last update(), although the map
   * still has them. */
  const std::vector<VoxelIndex>& leftVoxels() const;

  /** \brief The number of the object of each voxel, 0 = none. Numbers count from 1 in
   * the order of the first frames; some may be missing. An object that has shrunk below
   * min_voxels has no number.
   * \param[in] voxels any voxels of the map */
  std::vector<std::uint32_t> numbers(const VoxelCloud& voxels) const;

  /** \brief Describes the objects, in the order of their numbers, in the world frame.
   * \param[in] voxels all occupied voxels of the map, with VoxelCloud::objects of
   * numbers() */
  std::vector<ObjectSummary> summarize(const VoxelCloud& voxels) const;

  /** \brief The objects so far, with all that update() needs to continue. */
  MapObjects objects() const;

  /** \brief The same, but objects that have not changed since the last call are in
   * MapObjects::unchanged. */
  MapObjects takeChanges();

  /** \brief Continues from another tracker of the same map and parameters.
   * \param[in] objects of objects() */
  void restore(MapObjects objects);

private:
  struct State;

  std::unique_ptr<State> state_;
};

} // namespace pcl_semantic
