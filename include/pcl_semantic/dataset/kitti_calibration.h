// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>

#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The pairs of cameras of a KITTI recording. */
enum class KittiCameras {
  automatic, ///< colour if the folder `image_2` is there, else grey
  colour,    ///< `image_2` and `image_3`, P2 and P3
  grey       ///< `image_0` and `image_1`, P0 and P1
};

/** \brief The calibration of one stereo pair, from `calib.txt`.
 *
 * A row `Pi` is K [I | t_i]: a point in camera i is the point in camera 0 plus t_i. */
struct KittiCalibration {
  /** \brief The pair; the image size is unknown but in the raw data's file. The
   * baseline is t_left.x - t_right.x with t = K^-1 Pi[:, 3]; (P2[0][3] - P3[0][3]) /
   * fx, often seen, ignores that the two colour cameras differ by 3 mm in z and is 0.5
   * % too long. */
  StereoCamera camera;

  /** \brief Pose of the left camera of the pair in camera 0 [m]: takes points of the
   * pair's left camera to camera 0. */
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();

  /** \brief The row `Tr`, or `R0_rect` times `Tr_velo_to_cam`: takes points of the
   * laser scanner to camera 0 [m]. */
  std::optional<Eigen::Isometry3d> T_camera0_velodyne;
};

/** \brief Reads `calib.txt` of the odometry benchmark: rows `P0:` to `P3:` and, if it
 * is there, `Tr:`, each of 12 numbers; or calib_cam_to_cam.txt of the raw data,
 * `P_rect_00:` to `P_rect_03:` and the sizes, `S_rect_00:` and so on. Rows of other
 * names are passed over. \param[in] path file \param[in] cameras colour or grey; the
 * rows of that pair have to be there \throws BadInputException with the line, unless
 * the pair is a rectified one with positive focal length and baseline, and `Tr` is a
 * rigid transformation */
KittiCalibration readKittiCalibration(const std::string& path, KittiCameras cameras);

} // namespace pcl_semantic
