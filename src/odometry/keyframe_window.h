/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "circle_tracker.h"
#include "window_adjustment.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief A feature through the frames that saw it. */
struct FeatureTrack {
  struct Sighting {
    int frame = 0; ///< its place in the order of frames
    Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
  };

  AnchoredPoint place;
  int anchor = 0; ///< frame that saw it first
  Eigen::Isometry3d T_world_anchor = Eigen::Isometry3d::Identity();
  double anchor_disparity = 0.0;   ///< [px]
  std::vector<Sighting> sightings; ///< later ones, in keyframes and the newest frame
  StereoFeature now;
  bool is_alive = true; ///< still followed

  /** \brief For scaledPoint() with T_camera_world. */
  AnchoredPoint
  inWorld() const
  {
    return {scaledPoint(place, T_world_anchor), place.inverse_depth};
  }
};

/** \brief The last keyframes and the newest frame, and the tracks that tie them. */
class KeyframeWindow {
public:
  struct Frame {
    int number = 0; ///< place in the order of frames
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
  };

  KeyframeWindow(const StereoCamera& camera, const MeasurementNoise& noise)
      : camera_(camera), noise_(noise)
  {}

  std::vector<Frame> frames; ///< the newest last
  std::vector<FeatureTrack> tracks;

  /** \brief Adjusts all frames but the oldest, and the depths of all tracks; tracks that
   * do not fit then are given up.
   * \return covariance of the newest frame's T_camera_world, the others exact */
  Matrix6d adjust(int iterations);

  /** \brief Forgets the newest frame but keeps its pose in it for nobody. */
  void dropNewest();

  /** \brief Forgets the oldest frames until \a count are left, and the tracks that no
   * frame of the window needs. */
  void shrink(std::size_t count);

  void clear();

private:
  int indexOf(int number) const;

  StereoCamera camera_;
  MeasurementNoise noise_;
};

} // namespace pcl_semantic::odometry
