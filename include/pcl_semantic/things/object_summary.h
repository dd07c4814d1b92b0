// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Geometry>
#include <pcl/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief An upright box that is turned about the z axis. */
struct YawBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();   ///< along its own axes; x >= y [m]
  double yaw = 0.0; ///< of its x axis from the frame's x axis, -pi/2 .. pi/2 [rad]

  /** \brief The corners: the lower four, then the upper four, each counterclockwise
   * seen from above. */
  std::vector<Eigen::Vector3d> corners() const;

  /** \brief The edges, each as the indices of two corners. */
  static const std::array<std::pair<std::size_t, std::size_t>, 12> edges;
};

/** \brief Finds the upright box of the smallest base that contains all points.
 * \param[in] points one or more [m] */
YawBox smallestBox(const std::vector<Eigen::Vector3d>& points);

/** \brief Track of an object over the frames. */
struct ObjectTrack {
  int first_frame = 0, last_frame = 0; ///< numbers of the frames that saw it
  int frames = 0;                      ///< number of frames that saw it
  bool moving = false;                 ///< its place changed in the last frames
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();        ///< to the next frame [m]
  double speed = std::numeric_limits<double>::quiet_NaN(); ///< [m/s]; NaN = unknown
};

/** \brief An object of a labelled cloud, in the frame of the cloud, or of a map, in the
 * world frame. */
struct ObjectSummary {
  std::uint32_t id = 0;                             ///< from 1
  Label label = kUnlabelled;                        ///< its class
  std::vector<float> probabilities;                 ///< L, mean of its points; or empty
  std::size_t points = 0;                           ///< number of points
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< mean of its points [m]
  Eigen::AlignedBox3d box;                          ///< axis-aligned [m]
  YawBox yaw_box;
  std::optional<ObjectTrack> track; ///< of an object of a map
};

/** \brief Summarizes the points of an object, without id, label and probabilities.
 * \param[in] points one or more [m] */
ObjectSummary summarizeObject(const std::vector<Eigen::Vector3d>& points);

/** \brief Summarizes an object of a cloud, without id and label.
 * \param[in] indices one or more
 * \param[in] position of a point [m]
 * \param[in] distributions L x points of the cloud, or empty */
ObjectSummary
summarizeObject(const pcl::Indices& indices,
                const std::function<Eigen::Vector3d(std::size_t)>& position,
                const LabelDistributions& distributions);

} // namespace pcl_semantic
