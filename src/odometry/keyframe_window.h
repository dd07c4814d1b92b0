// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "feature_tracker.h"
#include "window_adjustment.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief A tracked feature and its measurements. */
struct FeatureTrack {
  struct Sighting {
    int frame = 0;                                 ///< index in the order of frames
    Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
  };

  AnchoredPoint position;
  int anchor = 0; ///< first frame with the feature
  Eigen::Isometry3d T_world_anchor = Eigen::Isometry3d::Identity();
  double anchor_disparity = 0.0;   ///< measured [px]
  std::vector<Sighting> sightings; ///< later ones, in keyframes and the newest frame
  StereoFeature now;               ///< current position
  StereoFeature next;              ///< position while a frame is processed
  bool is_alive = true;            ///< still tracked

  /** \brief The point for scaledPoint() with T_camera_world. */
  AnchoredPoint
  inWorld() const
  {
    return {scaledPoint(position, T_world_anchor), position.inverse_depth};
  }
};

/** \brief The last keyframes, the newest frame and the tracks that connect them. */
class KeyframeWindow {
public:
  struct Frame {
    int number = 0; ///< index in the order of frames
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
  };

  KeyframeWindow(const StereoCamera& camera, const MeasurementNoise& noise)
      : camera_(camera), noise_(noise)
  {}

  std::vector<Frame> frames; ///< the newest last
  std::vector<FeatureTrack> tracks;
  double offset = 0.0;            ///< of measured disparities [px]
  double offset_deviation = 1e-6; ///< its maximum change in one adjustment, standard
                                  ///< deviation [px]

  /** \brief Adjusts all frames except the oldest, the depths of all tracks and the
   * offset. Tracks that do not fit afterwards are dropped.
   * \return covariance of the newest frame's T_camera_world, given the other poses,
   * with the noise estimated from the residuals */
  Matrix6d adjust(int iterations);

  /** \brief Whether the newest frame should become a keyframe: the median feature
   * displacement since the previous frame exceeds \a flow [px], or many features are
   * lost. */
  bool newestBringsMuch(double flow) const;

  void dropNewest();

  /** \brief Removes the oldest frames until \a count are left, and the tracks that are
   * no longer needed. */
  void shrink(std::size_t count);

private:
  int indexOf(int number) const;

  std::vector<std::size_t> collect(WindowAdjustment& adjustment) const;

  double rejectOutliers(const WindowAdjustment& adjustment,
                        const std::vector<std::size_t>& adjusted);

  StereoCamera camera_;
  MeasurementNoise noise_;
};

} // namespace pcl_semantic::odometry
