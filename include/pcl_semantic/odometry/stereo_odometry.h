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
  int frame = 0; ///< its number

  /** \brief Pose of the frame's left camera in the world [m]. */
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();

  /** \brief Covariance of a small error of that pose, in the axes of the camera:
   * translation [m^2], then rotation [rad^2]. It grows along the way, as every frame
   * adds its motion's; 0 at the first frame. */
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  /** \brief Same, of the motion since the frame before alone. */
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();

  bool is_lost = false;          ///< the pose is the predicted one: nothing supports it
  bool is_keyframe = false;      ///< stays in the window
  int tracked = 0;               ///< features found again
  int inliers = 0;               ///< of those, how many agree with the pose
  double disparity_offset = 0.0; ///< what disparities were measured too large by [px]
};

/** \brief Poses from the stereo images alone.
 *
 * Corners are followed from frame to frame and from left to right (and back: a circle,
 * Geiger et al., StereoScan, 2011), a robust estimate of the motion picks those that
 * agree (RANSAC, Nister et al., 2004), and the poses of the last keyframes and the
 * depths of all points are adjusted together. Where too little can be followed the
 * motion of before goes on, the result says so, and the next frames start anew from
 * there. The same poses for any number of threads. See doc/odometry.md.
 *
 * Frames have to come in their order; a frame that comes twice in a row gets the same
 * pose. The world has its origin at camera 0 of the first frame. */
class StereoOdometry : public PoseSource {
public:
  struct Parameters {
    int features = 600;           ///< how many are followed at most
    int window = 8;               ///< keyframes that are adjusted together
    int iterations = 4;           ///< of the adjustment, at most
    int minimum_inliers = 12;     ///< with fewer the frame is lost
    int max_disparity = 0;        ///< of a new feature [px]; 0 = an eighth of the width
    double keyframe_flow = 0.015; ///< median way of the features that makes a keyframe,
                                  ///< in widths of the image
    double pixel_noise = 0.15;    ///< standard deviation of a feature's position [px]
    double disparity_noise = 0.3; ///< and of its disparity [px]

    /** \brief How far the offset that all disparities share, an error of the
     * rectification, may move from one keyframe to the next [px]; 0 = there is none. */
    double offset_drift = 0.03;

    /** \throws InvalidParameterException */
    void validate() const;
  };

  /** \param[in] camera of the rectified images
   * \param[in] T_camera0_camera the left camera in camera 0, the world's origin
   * \throws InvalidParameterException \throws BadInputException as requireRigid() */
  StereoOdometry(const StereoCamera& camera, const Eigen::Isometry3d& T_camera0_camera,
                 const Parameters& parameters);
  explicit StereoOdometry(
      const StereoCamera& camera,
      const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity());
  ~StereoOdometry() override;

  /** \brief T_world_camera of the frame, see process(). */
  Eigen::Isometry3d pose(const SensorFrame& frame) override;

  /** \brief Takes the next frame.
   * \throws BadInputException that names the frame, if the images are of another size
   * than each other or the camera's, or of another type than 8 bit grey or BGR */
  const OdometryResult& process(const StereoFrame& frame);

  /** \brief How many frames were lost since the beginning. */
  int lostFrames() const override;

private:
  class Engine;

  std::unique_ptr<Engine> engine_;
};

} // namespace pcl_semantic
