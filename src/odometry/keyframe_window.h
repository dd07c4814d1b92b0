// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "circle_tracker.h"
#include "window_adjustment.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief A feature through the frames that saw it. */
struct FeatureTrack {
  struct Sighting {
    int frame = 0; ///< its position in the order of frames
    Eigen::Vector3d uvd = Eigen::Vector3d::Zero(); ///< column, row, disparity [px]
  };

  AnchoredPoint position;
  int anchor = 0; ///< frame that saw it first
  Eigen::Isometry3d T_world_anchor = Eigen::Isometry3d::Identity();
  double anchor_disparity = 0.0;   ///< measured [px]
  std::vector<Sighting> sightings; ///< later ones, in keyframes and the newest frame
  StereoFeature now;               ///< where it was followed to
  StereoFeature next;              ///< while a frame is worked on
  bool is_alive = true;            ///< still followed

  /** \brief For scaledPoint() with T_camera_world. */
  AnchoredPoint
  inWorld() const
  {
    return {scaledPoint(position, T_world_anchor), position.inverse_depth};
  }
};

/** \brief The last keyframes and the newest frame, and the tracks that tie them. */
class KeyframeWindow {
public:
  struct Frame {
    int number = 0; ///< position in the order of frames
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
  };

  KeyframeWindow(const StereoCamera& camera, const MeasurementNoise& noise)
      : camera_(camera), noise_(noise)
  {}

  std::vector<Frame> frames; ///< the newest last
  std::vector<FeatureTrack> tracks;
  double offset = 0.0;            ///< of measured disparities [px]
  double offset_deviation = 1e-6; ///< how far it may move in one adjustment [px]

  /** \brief Adjusts all frames but the oldest, the depths of all tracks and the offset;
   * tracks that do not fit then are given up.
   * \return covariance of the newest frame's T_camera_world, the others exact, with the
   * noise that the residuals show */
  Matrix6d adjust(int iterations);

  /** \brief Whether the features have moved since the frame before the newest, by more
   * than \a flow [px] in the median, or many have gone. */
  bool newestBringsMuch(double flow) const;

  /** \brief Forgets the newest frame and what it saw. */
  void dropNewest();

  /** \brief Forgets the oldest frames until \a count are left, and the tracks that no
   * frame of the window needs. */
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
