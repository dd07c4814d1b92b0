// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>
#include <pcl/point_cloud.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One line of warning about positions that lost precision: at most points, the
 * step of single precision is coarser than a tenth of the point spacing. Empty
 * otherwise.
 * \param[in] positions 3 x N, single precision [m]
 * \param[in] origin that was subtracted from them [m]
 * \param[in] name of the cloud, for the warning */
std::string doubtOfSteps(const Eigen::Matrix3Xf& positions,
                         const Eigen::Vector3d& origin, const std::string& name);

/** \brief Does the same for a PCL cloud. */
template <typename PointT>
std::string
doubtOfSteps(const pcl::PointCloud<PointT>& cloud, const std::string& name,
             const Eigen::Vector3d& origin = Eigen::Vector3d::Zero())
{
  Eigen::Matrix3Xf positions(3, Eigen::Index(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    positions.col(Eigen::Index(i)) << cloud[i].x, cloud[i].y, cloud[i].z;
  return doubtOfSteps(positions, origin, name);
}

/** \brief Prints a warning by PCL_WARN, as PCL's filters do.
 * \param[in] filter its name
 * \param[in] doubt empty = nothing is printed */
void warnOfDoubt(const std::string& filter, const std::string& doubt);

} // namespace pcl_semantic
