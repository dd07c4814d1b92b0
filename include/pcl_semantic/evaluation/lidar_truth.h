// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What projectLidarTruth keeps. The window covers the gaps between the beams of
 * a 64-beam scanner (0.5 degrees) in KITTI's images. */
struct LidarTruthParameters {
  double max_depth = 40.0;       ///< camera z [m]
  int window_columns = 3;        ///< half width of the window for occlusion [px]
  int window_rows = 7;           ///< half height of it [px]
  double absolute_margin = 0.5;  ///< nearer by more than this ... [m]
  double relative_margin = 0.05; ///< ... and by more than this fraction of the depth
};

/** \brief The pixel that a point falls on; nothing if it is outside the image or
 * nearer than z = 0.1 m. \param[in] point camera frame [m] */
std::optional<Eigen::Vector2i> pixelOf(const Eigen::Vector3d& point,
                                       const StereoCamera& camera);

/** \brief Which points of a scan the camera sees.
 *
 * The nearest return of a pixel hides the others, unless they lie as near by one of the
 * margins. The scanner looks from another place than the camera, so returns from behind
 * an object shine through between the returns from the object: a return is hidden if,
 * within the window around its pixel, there are nearer returns (by both margins) both
 * at or above and at or below its row. One side alone does not hide it: the road rises
 * from nearer rows below, and what is seen above a roof is truly seen.
 * \param[in] scan points in the scanner's frame [m]
 * \param[in] camera pinhole with its image size
 * \param[in] T_camera_scanner pose of the scanner in the camera
 * \param[in] parameters see there
 * \return camera z of each point that is seen [m]; 0 = outside the image, hidden or too
 * far
 * \throws InvalidParameterException unless the image size is known */
std::vector<float> seenDepths(const pcl::PointCloud<pcl::PointXYZI>& scan,
                              const StereoCamera& camera,
                              const Eigen::Isometry3d& T_camera_scanner,
                              const LidarTruthParameters& parameters = {});

/** \brief What a labelled scan says of the pixels of an image. */
struct LidarTruth {
  cv::Mat labels; ///< CV_8UC1; 0 = no ground truth
  cv::Mat depth;  ///< CV_32FC1, camera z where there is ground truth [m]; else 0
};

/** \brief Projects a labelled scan into the left image: sparse ground truth, of each
 * pixel the nearest return if it is labelled and seen, see seenDepths(). \param[in]
 * labels one a point \throws InvalidParameterException unless the sizes fit and the
 * image size is known */
LidarTruth projectLidarTruth(const pcl::PointCloud<pcl::PointXYZI>& scan,
                             const std::vector<Label>& labels,
                             const StereoCamera& camera,
                             const Eigen::Isometry3d& T_camera_scanner,
                             const LidarTruthParameters& parameters = {});

} // namespace pcl_semantic
