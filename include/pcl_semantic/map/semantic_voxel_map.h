// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/map/block_store.h>
#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/scan.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A semantic occupancy map in a window that moves with the sensor.
 *
 * Scans of any sensor update occupancy by ray casting and fuse colour and label
 * distributions (section III of the paper). Blocks that leave the window move to a
 * BlockStore and return with the window. World frame: x forward, y left, z up [m].
 *
 * One thread may write (non-const methods) while others read. A reader sees the map
 * between two calls of the writer, and waits during a call. Exceptions of the store
 * pass through; the window then stays where it is. */
class SemanticVoxelMap {
public:
  using Ptr = std::shared_ptr<SemanticVoxelMap>;
  using ConstPtr = std::shared_ptr<const SemanticVoxelMap>;
  using Parameters = MapParameters;
  using VisitBlock = std::function<void(const VoxelIndex&, const VoxelBlock&)>;

  /** \param[in] label_set the classes of every distribution given to integrate()
   * \param[in] store null for a store in memory
   * \throws InvalidParameterException */
  SemanticVoxelMap(const LabelSet& label_set, const Parameters& parameters,
                   std::shared_ptr<BlockStore> store = nullptr);

  ~SemanticVoxelMap();

  /** \brief Integrates one scan: moves the window to the sensor, casts a ray to every
   * point, and fuses colours and labels of the end points. One update per voxel and
   * scan; a hit wins over a miss.
   * \param[in] cloud sensor frame [m], organized or not, any point type with xyz
   * \param[in] T_world_sensor pose of the sensor; sensorPose() gives that of the cloud
   * \param[in] distributions L x cloud.size(), or LabelDistributions() for a scan
   * without labels
   * \param[in] deviations standard deviations of the distance to each point [m], or
   * empty if the distances are exact. A ray clears nothing within two deviations of its
   * end, and its hit has less weight. A point whose deviation is NaN or negative is
   * skipped.
   * \throws InvalidParameterException if the sizes do not fit the cloud
   * \throws BadInputException if the pose is not rigid or too far away, or a
   * probability is negative or not finite */
  template <typename PointT>
  ScanCounts integrate(const pcl::PointCloud<PointT>& cloud,
                       const Eigen::Isometry3d& T_world_sensor,
                       const LabelDistributions& distributions = LabelDistributions(),
                       const std::vector<float>& deviations = {});

  /** \brief Fuses the labels of a scan that was integrated without them, as integrate()
   * would have: in each voxel that contains an end point and was hit. Voxels that have
   * left the window get no labels.
   * \param[in] cloud, T_world_sensor as for integrate()
   * \param[in] distributions L x cloud.size()
   * \return number of labelled voxels
   * \throws as integrate() */
  template <typename PointT>
  std::size_t addLabels(const pcl::PointCloud<PointT>& cloud,
                        const Eigen::Isometry3d& T_world_sensor,
                        const LabelDistributions& distributions);

  /** \brief Moves the window without a scan, for queries of a loaded map.
   * \param[in] centre world frame [m]
   * \throws BadInputException if it is too far away */
  void moveWindow(const Eigen::Vector3d& centre);

  /** \brief The occupied voxels of the window, or of the window and the store. */
  VoxelCloud occupied() const;
  VoxelCloud occupiedEverywhere() const;

  /** \brief Visits every block, stored ones included, by z, y, x of their indices.
   * \param[in] visit must not call the map */
  void forEachBlock(const VisitBlock& visit) const;

  /** \brief Writes the changed blocks to the store, which is then complete. */
  void flush();

  /** \brief Origin of the points of all returned clouds, world frame [m]: a multiple of
   * a kilometre near the first sensor, or the origin of the map that is continued. */
  Eigen::Vector3d cloudOrigin() const;

  void setCloudOrigin(const Eigen::Vector3d& origin);

  /** \brief Stores refined distributions. They hold until the voxel is measured again;
   * the measurements stay unchanged.
   * \param[in] voxels as occupied() returned them
   * \param[in] refined L x voxels.size()
   * \param[in] as_measured also replace the measured labels
   * \throws InvalidParameterException if a size does not fit or a value is no
   * probability */
  void setRefined(const VoxelCloud& voxels, const LabelDistributions& refined,
                  bool as_measured = false);

  /** \brief Occupancy at a point, world frame [m]; unknown outside the window. */
  Occupancy occupancy(const Eigen::Vector3d& point) const;

  /** \brief MAP labels (refined if available) of the occupied voxels at points, from
   * one state of the map; kUnlabelled elsewhere. */
  std::vector<Label> labels(const std::vector<Eigen::Vector3d>& points) const;

  VoxelState state(const Eigen::Vector3d& point) const;

  /** \brief The known voxels (free or occupied) that intersect a box, blocks by z, y,
   * x. */
  std::vector<VoxelState> states(const Eigen::AlignedBox3d& box) const;

  /** \brief The first occupied voxel along a segment; nothing if there is none, or an
   * end is not finite or too far away. */
  std::optional<VoxelState> firstOccupied(const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to) const;

  /** \brief The voxel that contains a point, world frame [m].
   * \throws InvalidParameterException if the point is not finite or too far away */
  VoxelIndex voxelOf(const Eigen::Vector3d& point) const;

  /** \brief Sets the number of threads of integrate() and of the queries, as
   * CRFSettings::setNumberOfThreads(). */
  void setNumberOfThreads(int threads);

  /** \brief Memory of the window and of the last scan, without the store [bytes]. */
  std::size_t memory() const;

  const LabelSet& labelSet() const;
  const Parameters& parameters() const;

private:
  struct State;

  ScanCounts integrateScan(const Scan& scan, const Eigen::Isometry3d& T_world_sensor);

  std::size_t addScanLabels(const Scan& scan, const Eigen::Isometry3d& T_world_sensor);

  std::unique_ptr<State> state_;
};

} // namespace pcl_semantic

#include <pcl_semantic/map/impl/semantic_voxel_map.hpp>
