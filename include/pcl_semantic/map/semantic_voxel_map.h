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
 * integrate() updates the occupancy by ray casting and fuses colours and label
 * distributions (section III of the paper). Scans may come from any sensor. Blocks that
 * leave the window move to a BlockStore. They return when the window contains them
 * again. World frame: x forward, y left, z up [m].
 *
 * One thread may write (non-const methods) while others read. A read waits while the
 * writer is inside a call. All methods pass on the exceptions of the store. An
 * exception of the store never moves the window. */
class SemanticVoxelMap {
public:
  using Ptr = std::shared_ptr<SemanticVoxelMap>;
  using ConstPtr = std::shared_ptr<const SemanticVoxelMap>;
  using Parameters = MapParameters;
  /** \brief Called with the index of a block, in units of blocks from the world origin,
   * and the block. */
  using VisitBlock = std::function<void(const VoxelIndex&, const VoxelBlock&)>;

  /** \param[in] label_set the classes of every distribution given to integrate()
   * \param[in] store null for a store in memory
   * \throws InvalidParameterException if a parameter is out of range */
  SemanticVoxelMap(const LabelSet& label_set, const Parameters& parameters,
                   std::shared_ptr<BlockStore> store = nullptr);

  ~SemanticVoxelMap();

  /** \brief Adds one scan to the map.
   *
   * The window moves to the sensor. A ray to every point updates the occupancy. The
   * voxels of the end points fuse the colours and labels of these points. Each scan
   * updates a voxel once. A hit takes precedence over a miss.
   * FusionParameters::per_ray_counting counts every ray instead.
   * \param[in] cloud sensor frame [m]; any point type with xyz, organized or not. If
   * the type has rgb or rgba, the colours are fused
   * \param[in] T_world_sensor pose of the sensor; for a cloud from a `.pcd` see
   * sensorPose()
   * \param[in] distributions L x cloud.size(), or LabelDistributions() for a scan
   * without labels
   * \param[in] deviations standard deviations of the distance to each point [m], or
   * empty if the distances are exact. A ray clears nothing within two deviations of its
   * end. A larger deviation gives the hit less weight. A point is skipped if its
   * deviation is NaN, negative, or 1e6 m or more
   * \throws InvalidParameterException unless \a distributions and \a deviations are of
   * the sizes above, or if the cloud has 2^31 points or more
   * \throws BadInputException if the pose is not rigid or too far away, or a
   * probability is negative or not finite */
  template <typename PointT>
  ScanCounts integrate(const pcl::PointCloud<PointT>& cloud,
                       const Eigen::Isometry3d& T_world_sensor,
                       const LabelDistributions& distributions = LabelDistributions(),
                       const std::vector<float>& deviations = {});

  /** \brief Fuses the labels of a scan that was integrated without labels.
   *
   * Labels are fused as in integrate(), in each voxel that has been hit and contains an
   * end point of the scan. Voxels that have left the window get no labels.
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
   * \throws BadInputException if the centre is not finite or too far away */
  void moveWindow(const Eigen::Vector3d& centre);

  /** \brief Makes voxels free, for example those that a moving object has left. They
   * lose their colours and labels. Voxels outside the window keep their state. */
  void setFree(const std::vector<VoxelIndex>& voxels);

  /** \brief The window: its voxels from min() to max(), both inside; empty before the
   * first scan. */
  Eigen::AlignedBox<int, 3> window() const;

  /** \brief The occupied voxels of the window. */
  VoxelCloud occupied() const;

  /** \brief The occupied voxels of the window and the store. */
  VoxelCloud occupiedEverywhere() const;

  /** \brief Visits every block of the window and the store, in the order z, y, x of the
   * indices.
   * \param[in] visit must not call the map */
  void forEachBlock(const VisitBlock& visit) const;

  /** \brief Writes the changed blocks to the store. The store then contains the whole
   * map. */
  void flush();

  /** \brief Origin of the points of all returned clouds, world frame [m]. It is a
   * multiple of a kilometre near the first sensor, unless setCloudOrigin() has set it.
   */
  Eigen::Vector3d cloudOrigin() const;

  /** \brief Sets cloudOrigin(), to continue another map.
   * \param[in] origin world frame [m]
   * \throws InvalidParameterException if the origin is not finite */
  void setCloudOrigin(const Eigen::Vector3d& origin);

  /** \brief Stores refined distributions. A voxel keeps its refined distribution until
   * a scan adds labels to the voxel. Voxels outside the window are ignored.
   * \param[in] voxels as occupied() returned them
   * \param[in] refined L x voxels.size()
   * \param[in] as_measured also replaces the fused measurements by \a refined
   * \throws InvalidParameterException unless \a refined is L x voxels.size(), or if a
   * value is no probability */
  void setRefined(const VoxelCloud& voxels, const LabelDistributions& refined,
                  bool as_measured = false);

  /** \brief Occupancy at a point, world frame [m]; unknown outside the window. */
  Occupancy occupancy(const Eigen::Vector3d& point) const;

  /** \brief The most probable labels (refined if available) of the voxels at points.
   * Points outside the window and points in voxels that are not occupied are
   * kUnlabelled. The writer does not change the map during the call.
   * \param[in] points world frame [m]
   * \return one label per point */
  std::vector<Label> labels(const std::vector<Eigen::Vector3d>& points) const;

  /** \brief The voxel that contains a point, world frame [m]. Outside the window, its
   * occupancy is unknown. */
  VoxelState state(const Eigen::Vector3d& point) const;

  /** \brief The known voxels (free or occupied) of the window that intersect a box.
   * \param[in] box world frame [m]
   * \return voxels in the order of VoxelCloud; none if the box is empty or NaN */
  std::vector<VoxelState> states(const Eigen::AlignedBox3d& box) const;

  /** \brief The first occupied voxel of the window along a segment.
   * \param[in] from, to ends of the segment, world frame [m]
   * \return nothing if no voxel is occupied, or an end is not finite or too far away */
  std::optional<VoxelState> firstOccupied(const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to) const;

  /** \brief The voxel that contains a point, world frame [m].
   * \throws InvalidParameterException if the point is not finite or too far away */
  VoxelIndex voxelOf(const Eigen::Vector3d& point) const;

  /** \brief Sets the error of the distances in the next scans: their standard deviation
   * divided by the squared distance [1/m], 0 (the default) for exact distances. For
   * stereo it is the deviation of a disparity divided by focal length and baseline.
   * Rays have to end farther behind a voxel of a dynamic class to free it, and labels
   * are weighted (FusionParameters::weigh_labels).
   * \throws InvalidParameterException unless finite and not negative */
  void setDepthError(double error);

  double depthError() const;

  /** \brief Sets the number of threads of integrate() and of the queries.
   * \param[in] threads as CRFSettings::setNumberOfThreads() */
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
