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
 * distributions (section III of the paper). Blocks that leave the window go to a
 * BlockStore and come back when it returns. World frame: x forward, y left, z up [m].
 *
 * One thread may write (what is not const) while any number of others read: a reader
 * sees the map as it stands between two calls of the writer, and waits while one of
 * them runs. What the store throws comes through; the window then stays where it is. */
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

  /** \brief Takes in one scan: moves the window to the sensor, casts a ray to every
   * point, and fuses colours and labels of the ends. One update per voxel and scan; a
   * hit wins over a miss.
   * \param[in] cloud sensor frame [m], organized or not, any point type with xyz
   * \param[in] T_world_sensor pose of the sensor; sensorPose() gives that of the cloud
   * \param[in] distributions L x cloud.size(), or LabelDistributions() for a scan
   * without labels \param[in] deviations of the distance to each point [m], or empty if
   * they are exact: nothing is cleared within two deviations of an end, and its hit
   * weighs less; a point whose deviation is NaN or negative is skipped \throws
   * InvalidParameterException if the sizes do not fit the cloud \throws
   * BadInputException if the pose is no rigid motion, or too far away, or a probability
   * is negative or not finite */
  template <typename PointT>
  ScanCounts integrate(const pcl::PointCloud<PointT>& cloud,
                       const Eigen::Isometry3d& T_world_sensor,
                       const LabelDistributions& distributions = LabelDistributions(),
                       const std::vector<float>& deviations = {});

  /** \brief Fuses the labels of a scan that was taken in without them: in each voxel
   * that an end point lies in and some scan has hit, as integrate() would have. Voxels
   * that have left the window get none.
   * \param[in] cloud, T_world_sensor as they were given to integrate()
   * \param[in] distributions L x cloud.size()
   * \return voxels that got a label
   * \throws as integrate() */
  template <typename PointT>
  std::size_t addLabels(const pcl::PointCloud<PointT>& cloud,
                        const Eigen::Isometry3d& T_world_sensor,
                        const LabelDistributions& distributions);

  /** \brief Moves the window without a scan, as for queries of a loaded map.
   * \param[in] centre world frame [m] \throws BadInputException if too far away */
  void moveWindow(const Eigen::Vector3d& centre);

  /** \brief The occupied voxels: of the window, and also of what left it. */
  VoxelCloud occupied() const;
  VoxelCloud occupiedEverywhere() const;

  /** \brief Visits every block, those that left the window too, by z, y, x of their
   * indices. \param[in] visit must not call the map */
  void forEachBlock(const VisitBlock& visit) const;

  /** \brief Puts the blocks that have changed into the store: it then holds all. */
  void flush();

  /** \brief Origin of the points of all clouds given out, world frame [m]: a multiple
   * of a kilometre near the first sensor, or what a map that goes on was given. */
  Eigen::Vector3d cloudOrigin() const;

  void setCloudOrigin(const Eigen::Vector3d& origin);

  /** \brief Takes back refined distributions. They hold until the voxel is measured
   * again; the measurements stay as they are.
   * \param[in] voxels as occupied() gave them
   * \param[in] refined L x voxels.size()
   * \param[in] as_measured they also take the place of the labels measured so far
   * \throws InvalidParameterException for other sizes, or what is no probability */
  void setRefined(const VoxelCloud& voxels, const LabelDistributions& refined,
                  bool as_measured = false);

  /** \brief Queries of the window, world frame [m]; what lies outside is unknown. */
  Occupancy occupancy(const Eigen::Vector3d& point) const;

  /** \brief MAP labels (refined if there are some) of the occupied voxels at points,
   * all at one moment; kUnlabelled where there is none. */
  std::vector<Label> labels(const std::vector<Eigen::Vector3d>& points) const;

  VoxelState state(const Eigen::Vector3d& point) const;

  /** \brief The known voxels (free or occupied) that meet a box, blocks by z, y, x. */
  std::vector<VoxelState> states(const Eigen::AlignedBox3d& box) const;

  /** \brief The occupied voxel that a segment meets first; nothing if there is none, or
   * an end is not finite or absurdly far. */
  std::optional<VoxelState> firstOccupied(const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to) const;

  /** \brief The voxel that holds a point, world frame [m], as scans hit it.
   * \throws InvalidParameterException if the point is not finite or absurdly far */
  VoxelIndex voxelOf(const Eigen::Vector3d& point) const;

  /** \brief Threads of integrate() and of the functions that give out voxels, as
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
