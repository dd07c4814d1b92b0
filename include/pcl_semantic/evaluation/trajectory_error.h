// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <cstddef>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Errors of the pieces of one length, or of all. */
struct SegmentErrors {
  double length = 0.0;      ///< of the pieces [m]; 0 for all lengths together
  std::size_t segments = 0; ///< how many pieces there are
  double translation = 0.0; ///< mean error by length [1]; NaN without pieces
  double rotation = 0.0;    ///< mean error by length [rad/m]; NaN without pieces
};

/** \brief KITTI's errors (Geiger et al., 2012): a piece begins at every \a step-th pose
 * and ends at the first whose way along the ground truth is more than its length
 * further; its error is that of the motion from end to end, E = (motion of the
 * estimate)^-1 (motion of the ground truth), divided by the length.
 *
 * \param[in] truth, estimate poses of the same frames \param[in] lengths of pieces [m]
 * \param[in] step KITTI's own is 10, for sequences of thousands of frames
 * \return one entry a length, then one of all pieces together
 * \throws InvalidParameterException if the sizes differ, a length is not positive or
 * the step is less than 1 */
std::vector<SegmentErrors> kittiErrors(const Trajectory& truth,
                                       const Trajectory& estimate,
                                       const std::vector<double>& lengths,
                                       int step = 1);

/** \brief Distances between positions of the same frames [m]. */
struct AbsoluteErrors {
  double mean = 0.0;
  double rms = 0.0;
  double largest = 0.0;
  double last = 0.0; ///< of the last frame
};

/** \brief With the first poses brought into one another.
 * \throws InvalidParameterException if the sizes differ or there are no poses */
AbsoluteErrors errorsFromStart(const Trajectory& truth, const Trajectory& estimate);

/** \brief With the estimate moved rigidly to where the squared distances are least
 * (Umeyama 1991, no scale). \throws as errorsFromStart() */
AbsoluteErrors errorsAligned(const Trajectory& truth, const Trajectory& estimate);

/** \brief Way along a trajectory [m]. */
double lengthOf(const Trajectory& trajectory);

/** \brief Pairs of poses that belong together. */
struct MatchedTrajectories {
  Trajectory first, second;
};

/** \brief By time: every pose of \a first with the nearest of \a second, if that is
 * within \a tolerance [s] and no other of \a first is nearer to it. */
MatchedTrajectories matchByTime(const TimedTrajectory& first,
                                const TimedTrajectory& second, double tolerance);

/** \brief How far an estimated trajectory is from the true one. */
struct TrajectoryErrors {
  std::size_t poses = 0;
  double length = 0.0;               ///< of the true one [m]
  std::vector<SegmentErrors> pieces; ///< by length, the last of all together
  AbsoluteErrors from_start;
  AbsoluteErrors aligned;
};

/** \brief A table for people. */
std::string trajectoryTable(const TrajectoryErrors& errors);

/** \brief Translation in percent, rotation in degrees/m, distances in metres; null
 * where there are no pieces. */
std::string trajectoryJson(const TrajectoryErrors& errors);

} // namespace pcl_semantic
