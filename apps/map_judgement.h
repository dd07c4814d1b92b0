// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Warnings at the end of a run whose map is doubtful,
 * in the order of the functions. */

/** \brief Warns of poses that are predicted. \param[in] sequence its name
 * \throws BadInputException if no frame but the first, which is the origin, could be
 * tracked */
void judgeTracking(const std::string& sequence, int lost, int frames);

void judgeCalibration(const std::string& calibration, double domain_shift);

void warnOfEmptyMap();

/** \brief Warns, once a run, of a frame that is farther from the one before it than
 * points are mapped: such poses are of other frames, or not in metres. */
class PoseWatch {
public:
  /** \param[in] farthest [m] */
  explicit PoseWatch(double farthest) : farthest_(farthest) {}

  void look(int frame, const Eigen::Vector3d& position);

private:
  double farthest_;
  std::optional<Eigen::Vector3d> last_; ///< position of the frame before
  bool has_warned_ = false;
};

} // namespace pcl_semantic::tool
