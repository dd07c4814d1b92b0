// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/core/visible_points.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Camera z of each point of a scan that the camera sees, see seenPoints() [m];
 * 0 of the others. \param[in] scan points in the scanner's frame [m]
 * \param[in] T_camera_scanner pose of the scanner in the camera */
std::vector<float> seenDepths(const pcl::PointCloud<pcl::PointXYZI>& scan,
                              const StereoCamera& camera,
                              const Eigen::Isometry3d& T_camera_scanner,
                              const VisibilityParameters& parameters = {});

/** \brief What a labelled scan says of the pixels of an image. */
struct LidarTruth {
  cv::Mat labels; ///< CV_8UC1; 0 = no ground truth
  cv::Mat depth;  ///< CV_32FC1, camera z where there is ground truth [m]; else 0
};

/** \brief Projects a labelled scan into the left image: sparse ground truth, of each
 * pixel the nearest return if it is labelled and seen, see seenPoints(). \param[in]
 * labels one a point \throws InvalidParameterException unless the sizes fit and the
 * image size is known */
LidarTruth projectLidarTruth(const pcl::PointCloud<pcl::PointXYZI>& scan,
                             const std::vector<Label>& labels,
                             const StereoCamera& camera,
                             const Eigen::Isometry3d& T_camera_scanner,
                             const VisibilityParameters& parameters = {});

} // namespace pcl_semantic
