/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <vector>

namespace pcl_semantic {

/** \brief What projectLidarTruth keeps. The window covers the gaps between the beams of
 * a 64-beam scanner (0.5 degrees) in KITTI's images. */
struct LidarTruthParameters {
  double max_depth = 40.0;       ///< camera z [m]
  int window_columns = 3;        ///< half width of the window for occlusion [px]
  int window_rows = 7;           ///< half height of it [px]
  double absolute_margin = 0.5;  ///< nearer by more than this ... [m]
  double relative_margin = 0.05; ///< ... and by more than this share of the depth
};

/** \brief Projects a labelled scan into the left image: a sparse truth image.
 *
 * The nearest return of a pixel wins, labelled or not. The scanner looks from another
 * place than the camera, so returns from behind an object shine through between the
 * returns from the object: a return is dropped if, within the window around its pixel,
 * there are nearer returns (by both margins) both at or above and at or below its row.
 * One side alone does not hide it: the road rises from nearer rows below, and what is
 * seen above a roof is truly seen.
 * \param[in] scan points in the scanner's frame [m]
 * \param[in] labels one a point
 * \param[in] camera pinhole with its image size
 * \param[in] T_camera_scanner pose of the scanner in the camera
 * \param[in] parameters see there
 * \return CV_8UC1, height x width; 0 = no truth
 * \throws InvalidParameterException unless the sizes fit and the image size is known */
cv::Mat projectLidarTruth(const pcl::PointCloud<pcl::PointXYZI>& scan,
                          const std::vector<Label>& labels, const StereoCamera& camera,
                          const Eigen::Isometry3d& T_camera_scanner,
                          const LidarTruthParameters& parameters = {});

} // namespace pcl_semantic
