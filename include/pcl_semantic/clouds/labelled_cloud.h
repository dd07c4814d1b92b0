// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Geometry>
#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A cloud of any sensor with what is known of its labels. */
struct LabelledCloud {
  /** \brief Organized as the file was; viewpoint in its sensor_origin_ and
   * sensor_orientation_; points that are not finite keep their place. Positions are
   * relative to \a origin. */
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZRGBL>};
  LabelDistributions distributions;       ///< L x points; no classes: hard labels only
  std::vector<pcl::PointIndices> cliques; ///< of finite points, disjoint, none empty
  bool has_colour = false;                ///< whether the cloud's colours mean anything
  bool has_labels = false;                ///< likewise its labels
  PcdTable table; ///< the file it comes from, for the fields this struct does not know
  /// What was taken off the positions, see localOrigin(); zero unless the file has them
  /// in double precision and far away [m].
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool is_single = true; ///< the file's positions hold no more than single precision
};

/** \brief The positions of a cloud's points as its file has them, in double precision.
 * The cloud has to stay. */
class CloudPositions {
public:
  explicit CloudPositions(const LabelledCloud& labelled);

  /** \return of the i-th point [m] */
  Eigen::Vector3d
  operator()(std::size_t i) const
  {
    if (columns_.empty())
      return cloud_[i].getVector3fMap().cast<double>();
    return {columns_[0](i), columns_[1](i), columns_[2](i)};
  }

private:
  const pcl::PointCloud<pcl::PointXYZRGBL>& cloud_;
  std::vector<PcdColumn> columns_; // x y z, where the cloud is relative to an origin
};

/** \brief Adds the origin to the points of a cloud again, as far as single precision
 * holds it: for scans, which are relative to their sensor. */
void addOrigin(LabelledCloud& labelled);

/** \brief T_world_sensor that a cloud's VIEWPOINT states.
 * \param[in] name of the cloud, for the message
 * \throws BadInputException if its quaternion is none */
Eigen::Isometry3d viewpointOf(const PcdTable& table, const std::string& name);

/** \brief The points of a table with their labels, as readLabelledCloud() reads them.
 * \param[in] name of the cloud for messages
 * \param[in] mapping of the numbers in `label` to labels, others are unlabelled and
 * counted there; null = they are labels
 * \throws BadInputException as readLabelledCloud() */
LabelledCloud labelledCloudOf(PcdTable table, const std::string& name,
                              const LabelMapping* mapping = nullptr);

/** \brief Moves the points of a map's cloud, which says its PcdTable::voxel_grid, to
 * the centres of their voxels, where the CRF of the map saw them; other clouds stay.
 * The table keeps the positions of the file. */
void moveToVoxelCentres(LabelledCloud& labelled);

/** \brief The table that writeLabelledCloud() writes. \param[in] name for messages */
PcdTable tableOf(const LabelledCloud& labelled, const std::string& name);

} // namespace pcl_semantic
