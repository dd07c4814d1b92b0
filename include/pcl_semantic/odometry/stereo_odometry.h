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
  int frame = 0;

  /** \brief Pose of the frame's left camera in the world [m]. */
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();

  /** \brief Covariance of the error of T_world_camera, in the axes of the left camera:
   * translation [m^2], then rotation [rad^2]. It is 0 at the first frame. Every frame
   * adds the covariance of its motion. */
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  /** \brief Covariance of the motion since the previous frame, in the same axes and
   * units. */
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();

  bool is_lost = false;          ///< tracking failed: the pose is only predicted
  bool is_keyframe = false;      ///< later adjustments use this frame
  int tracked = 0;               ///< matched features
  int inliers = 0;               ///< matched features that agree with the pose
  double disparity_offset = 0.0; ///< measured minus true disparity, estimated [px]
};

/** \brief Visual odometry of stereo pairs or RGB-D frames.
 *
 * Each corner is tracked from the previous left image through the current left, current
 * right and previous right image back to its start (Geiger et al., StereoScan, 2011).
 * RANSAC (Nister et al., 2004) selects the corners that agree with one motion. A bundle
 * adjustment refines the poses of the last keyframes and the depths of all points. See
 * doc/odometry.md.
 *
 * RGB-D frames take the same way: a depth becomes the disparity of a pair, see
 * cameraOfDepths(). Corners are tracked from image to image and back.
 *
 * If too few features agree, the pose is predicted from the previous motion, and
 * tracking restarts from this pose. OdometryResult::is_lost reports such frames. Poses
 * do not depend on the number of threads.
 *
 * Frames must be in order. A frame passed twice in a row gets the same pose. The world
 * has its origin at camera 0 of the first frame: x forward, y left, z up. */
class StereoOdometry : public PoseSource {
public:
  struct Parameters {
    int features = 600;           ///< maximum number of tracked features
    int window = 8;               ///< keyframes in the adjustment
    int iterations = 4;           ///< maximum iterations of the adjustment
    int minimum_inliers = 12;     ///< a frame with fewer inliers is lost
    int max_disparity = 0;        ///< limit for new features [px]; 0 = width / 8
    double keyframe_flow = 0.015; ///< median feature displacement that makes a keyframe
                                  ///< [image widths]
    double pixel_noise = 0.15;    ///< standard deviation of a feature's position [px]
    double disparity_noise = 0.3; ///< standard deviation of its disparity [px]

    /** \brief Prior standard deviation of the change of
     * OdometryResult::disparity_offset in one adjustment [px]; 0 = no offset.
     * Rectification errors add this offset to all disparities. */
    double offset_drift = 0.03;

    /** \throws InvalidParameterException that names the parameter and its range */
    void validate() const;
  };

  /** \param[in] camera of the rectified images. If its width or height is 0, the first
   * images set it
   * \param[in] T_camera0_camera pose of the left camera in camera 0
   * \throws InvalidParameterException if a parameter is out of range
   * \throws BadInputException if the pose is not rigid */
  StereoOdometry(const StereoCamera& camera, const Eigen::Isometry3d& T_camera0_camera,
                 const Parameters& parameters);
  explicit StereoOdometry(
      const StereoCamera& camera,
      const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity());
  ~StereoOdometry() override;

  /** \brief The parameters for RGB-D frames: a disparity noise of 0.1 px and no
   * disparity offset. */
  static Parameters parametersOfDepths();

  /** \brief The camera of RGB-D frames as a pair with a baseline of 0.075 m, that of
   * the Kinect. With parametersOfDepths() and a focal length of 585 px, the standard
   * deviation of a depth z is 0.0023 z^2 / m. */
  static StereoCamera cameraOfDepths(StereoCamera camera);

  /** \brief Processes a frame and returns its OdometryResult::T_world_camera.
   * \throws BadInputException as process(), or if the frame is a cloud */
  Eigen::Isometry3d pose(const SensorFrame& frame) override;

  /** \brief Processes the next frame.
   * \throws BadInputException that names the frame, if the images differ in size from
   * each other or the camera, or are not 8 bit grey or BGR */
  const OdometryResult& process(const StereoFrame& frame);

  /** \brief Processes the next RGB-D frame. All frames are of one kind.
   * \throws BadInputException that names the frame, if its image does not have the size
   * of its depths or of the camera, or is not 8 bit grey or BGR */
  const OdometryResult& process(const RgbdFrame& frame);

  /** \brief The result of the last frame. */
  const OdometryResult& result() const;

  int lostFrames() const override;

private:
  class Engine;

  std::unique_ptr<Engine> engine_;
};

} // namespace pcl_semantic
