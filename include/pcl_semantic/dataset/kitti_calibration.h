// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The camera pairs of a KITTI recording. */
enum class KittiCameras {
  automatic, ///< colour if the folder `image_2` exists, else grey
  colour,    ///< `image_2` and `image_3`, P2 and P3
  grey       ///< `image_0` and `image_1`, P0 and P1
};

/** \brief The calibration of one stereo pair, from `calib.txt`.
 *
 * A row `Pi` is K [I | t_i]: a point in camera i is the point in camera 0 plus t_i. */
struct KittiCalibration {
  /** \brief The pair. Only raw data's file has the image size. The baseline is t_left.x
   * - t_right.x with t = K^-1 Pi[:, 3]. The common formula (P2[0][3] - P3[0][3]) / fx
   * ignores that the colour cameras differ by 3 mm in z; its result is 0.5 % too
   * long. */
  StereoCamera camera;

  /** \brief Pose of the pair's left camera in camera 0 [m]. */
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();

  /** \brief Pose of the laser scanner in camera 0 [m]: the row `Tr`, or `R0_rect` times
   * `Tr_velo_to_cam`. */
  std::optional<Eigen::Isometry3d> T_camera0_velodyne;
};

/** \brief Reads `calib.txt` of the odometry benchmark: rows `P0:` to `P3:` and
 * optionally `Tr:`, of 12 numbers each; or calib_cam_to_cam.txt of the raw data:
 * `P_rect_00:` to `P_rect_03:` and the sizes, `S_rect_00:` and so on. Other rows are
 * ignored.
 * \param[in] path file
 * \param[in] cameras colour or grey; the rows of this pair are required
 * \throws BadInputException with the line, unless the pair is rectified with positive
 * focal length and baseline, and `Tr` is a rigid transformation */
KittiCalibration readKittiCalibration(const std::string& path, KittiCameras cameras);

} // namespace pcl_semantic
