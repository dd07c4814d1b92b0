// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/evaluation/reliability.h>
#include <pcl_semantic/map/block_store.h>

#include <Eigen/Geometry>

#include <array>
#include <string>
#include <unordered_map>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether probabilities of occupancy are as often right as they say: the known
 * voxels of a map against laser scans that did not go into it.
 *
 * A voxel that beams of a scan reach is occupied in truth if one of them ends in it or
 * in one of the 26 around it, else free. What the map says is occupancyProbability() of
 * its log-odds. */
class OccupancyReliability {
public:
  /** \param[in] map its known voxels are copied
   * \param[in] voxel_size [m] */
  OccupancyReliability(const BlockStore& map, double voxel_size);

  /** \brief Counts the voxels that a scan reaches.
   * \param[in] points of the scan, its frame [m]; those nearer than 2 m are of what
   * carries the scanner, others than finite ones are none
   * \param[in] T_world_scanner its pose in the map */
  void addScan(const std::vector<Eigen::Vector3d>& points,
               const Eigen::Isometry3d& T_world_scanner);

  const Reliability::Curve&
  curve() const
  {
    return curve_;
  }

private:
  using LogOdds = std::array<StoredLogOdds, kBlockVoxels>;

  double voxel_size_;
  std::unordered_map<VoxelIndex, LogOdds, VoxelIndexHash> blocks_;
  Reliability::Curve curve_;
};

/** \brief expectedCalibrationError() of the voxels whose probability lies between 0.2
 * and 0.8, 0..1; NaN if there are none. */
double undecidedError(const Reliability::Curve& curve);

/** \brief That error and the curve as text, a bin a line. */
std::string occupancyTable(const Reliability::Curve& curve);

/** \brief The same as JSON; ratios are 0..1, null where there is none. */
std::string occupancyJson(const Reliability::Curve& curve);

} // namespace pcl_semantic
