// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <Eigen/Core>

#include <memory>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Result of StereoOdometry for one frame. */
struct OdometryResult {
  int frame = 0; ///< frame number

  /** \brief Pose of the frame's left camera in the world [m]. */
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();

  /** \brief Covariance of a small error of that pose, in the axes of the camera:
   * translation [m^2], then rotation [rad^2]. Every frame adds the covariance of its
   * motion; 0 at the first frame. */
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  /** \brief Covariance of the motion since the previous frame, likewise. */
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();

  bool is_lost = false;          ///< the pose is predicted without measurements
  bool is_keyframe = false;      ///< stays in the window
  int tracked = 0;               ///< matched features
  int inliers = 0;               ///< matched features that agree with the pose
  double disparity_offset = 0.0; ///< estimated bias of the disparities [px]
};

/** \brief Stereo visual odometry.
 *
 * Corners are tracked in a circle: between frames and between left and right images
 * (Geiger et al., StereoScan, 2011). RANSAC (Nister et al., 2004) selects those that
 * agree with one motion. A bundle adjustment refines the poses of the last keyframes
 * and the depths of all points. With too few features the pose is predicted by the
 * previous motion, the result reports it, and tracking restarts from there. Poses do
 * not depend on the number of threads. See doc/odometry.md.
 *
 * Frames must be in order; a frame passed twice in a row gets the same pose. The world
 * origin is camera 0 of the first frame. */
class StereoOdometry : public PoseSource {
public:
  struct Parameters {
    int features = 600;           ///< maximum number of tracked features
    int window = 8;               ///< keyframes in the adjustment
    int iterations = 4;           ///< maximum iterations of the adjustment
    int minimum_inliers = 12;     ///< with fewer the frame is lost
    int max_disparity = 0;        ///< of a new feature [px]; 0 = an eighth of the width
    double keyframe_flow = 0.015; ///< median feature displacement that makes a keyframe
                                  ///< [image widths]
    double pixel_noise = 0.15;    ///< standard deviation of a feature's position [px]
    double disparity_noise = 0.3; ///< standard deviation of its disparity [px]

    /** \brief Maximum change, between keyframes, of the offset that all disparities
     * share because of rectification errors [px]; 0 = no offset. */
    double offset_drift = 0.03;

    /** \throws InvalidParameterException */
    void validate() const;
  };

  /** \param[in] camera of the rectified images
   * \param[in] T_camera0_camera pose of the left camera in camera 0, the world origin
   * \throws InvalidParameterException
   * \throws BadInputException as requireRigid() */
  StereoOdometry(const StereoCamera& camera, const Eigen::Isometry3d& T_camera0_camera,
                 const Parameters& parameters);
  explicit StereoOdometry(
      const StereoCamera& camera,
      const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity());
  ~StereoOdometry() override;

  /** \brief T_world_camera of the frame, see process(). */
  Eigen::Isometry3d pose(const SensorFrame& frame) override;

  /** \brief Processes the next frame.
   * \throws BadInputException that names the frame, if the images differ in size from
   * each other or the camera, or are not 8 bit grey or BGR */
  const OdometryResult& process(const StereoFrame& frame);

  int lostFrames() const override;

private:
  class Engine;

  std::unique_ptr<Engine> engine_;
};

} // namespace pcl_semantic
