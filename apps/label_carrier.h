// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sequence_options.h"

#include <pcl_semantic/core/visible_points.h>
#include <pcl_semantic/dataset/camera_images.h>
#include <pcl_semantic/labelling/label_predictor.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Gives a scanner's clouds the labels of a camera's images. */
class LabelCarrier {
public:
  /** \param[in] images a folder in KITTI's layout, or the files of one camera: `left`
   * and its intrinsics as `calibration`
   * \param[in] sensor_pose file with the pose of the scanner in the camera; empty =
   * that of the sequence \param[in] visibility which points the camera sees \throws
   * BadInputException */
  LabelCarrier(const SequenceOptions& images, const std::string& sensor_pose,
               const VisibilityParameters& visibility);

  /** \brief Before the work: \throws BadInputException if there is no image of a frame
   * \param[in] cloud of that frame, for the message */
  void requireImage(const std::string& cloud, int frame) const;

  /** \brief Class distributions of a frame's points; what the camera does not see is
   * unlabelled. \param[in] cloud the scanner's frame [m] */
  LabelDistributions label(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud, int frame,
                           LabelPredictor& predictor) const;

private:
  VisibilityParameters visibility_;
  Eigen::Isometry3d T_camera_sensor_ = Eigen::Isometry3d::Identity();
  std::optional<CameraImages> images_; ///< in which the camera saw the points
};

} // namespace pcl_semantic::tool
