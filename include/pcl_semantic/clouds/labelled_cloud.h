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

/** \brief A cloud of any sensor with its labels, distributions and cliques. */
struct LabelledCloud {
  /** \brief Organized as in the file, with the viewpoint in sensor_origin_ and
   * sensor_orientation_. Non-finite points keep their index. Positions are relative to
   * \a origin. */
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZRGBL>};
  LabelDistributions distributions; ///< L x points; no classes: hard labels only
  std::vector<pcl::PointIndices>
      cliques;             ///< disjoint groups of finite points, none empty
  bool has_colour = false; ///< false: the cloud's colours are undefined
  bool has_labels = false; ///< false: the cloud's labels are undefined
  PcdTable table; ///< contents of the file, including fields that this struct does not
                  ///< interpret
  /// Origin that was subtracted from the positions, see localOrigin() [m]; zero unless
  /// the file has them in double precision and far away.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool is_single = true; ///< the file's positions need no more than single precision
};

/** \brief The positions of a cloud's points in double precision, as in its file. The
 * cloud must outlive this object. */
class CloudPositions {
public:
  explicit CloudPositions(const LabelledCloud& labelled);

  /** \return position of the i-th point [m] */
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

/** \brief Positions in the file minus those of the cloud, for CloudCRF::setRemainders()
 * [m]. Empty if no position isFarOff(). */
Eigen::Matrix3Xf remaindersOf(const LabelledCloud& labelled);

/** \brief Adds the origin to the points of a cloud again, in single precision. For
 * scans, which are relative to their sensor. */
void addOrigin(LabelledCloud& labelled);

/** \brief T_world_sensor from a cloud's VIEWPOINT.
 * \param[in] name of the cloud, for the message
 * \throws BadInputException if its quaternion is invalid */
Eigen::Isometry3d viewpointOf(const PcdTable& table, const std::string& name);

/** \brief Converts a table to points with labels, as readLabelledCloud() does.
 * \param[in] name of the cloud, for messages
 * \param[in] mapping from the numbers in `label` to labels; unmapped numbers become
 * unlabelled and are counted there. null = the numbers are labels
 * \throws BadInputException as readLabelledCloud() */
LabelledCloud labelledCloudOf(PcdTable table, const std::string& name,
                              const LabelMapping* mapping = nullptr);

/** \brief Moves the points of a map's cloud (one with a PcdTable::voxel_grid) to the
 * centres of their voxels, the positions that the map's CRF used. Other clouds stay
 * unchanged. The table keeps the positions of the file. */
void moveToVoxelCentres(LabelledCloud& labelled);

/** \brief The table that writeLabelledCloud() writes.
 * \param[in] name of the cloud, for messages */
PcdTable tableOf(const LabelledCloud& labelled, const std::string& name);

} // namespace pcl_semantic
