// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/trajectory_file.h>

#include <cstddef>
#include <vector>

namespace pcl_semantic {

/** \brief Errors over the segments of a trajectory. */
struct SegmentErrors {
  std::size_t segments = 0; ///< number of segments
  double translation = 0.0; ///< mean translation error / length [1]; NaN without
                            ///< segments
  double rotation = 0.0;    ///< mean rotation error / length [rad/m]; NaN without
                            ///< segments
};

/** \brief Path length from the first pose of a trajectory to each pose [m]. */
inline std::vector<double>
waysAlong(const Trajectory& trajectory)
{
  std::vector<double> ways(trajectory.size(), 0.0);
  for (std::size_t i = 1; i < ways.size(); ++i)
    ways[i] = ways[i - 1] +
              (trajectory[i].translation() - trajectory[i - 1].translation()).norm();
  return ways;
}

/** \brief KITTI's errors (Geiger et al., 2012). A segment begins at every pose and ends
 * at the first pose whose path length along the ground truth exceeds its length. Its
 * error is that of the motion between its ends, divided by the length.
 * \param[in] truth, estimate poses of the same frames
 * \param[in] lengths of segments [m]
 * \return mean over all segments */
inline SegmentErrors
kittiErrors(const Trajectory& truth, const Trajectory& estimate,
            const std::vector<double>& lengths)
{
  const std::vector<double> ways = waysAlong(truth);
  SegmentErrors sum;
  for (const double length : lengths)
    for (std::size_t begin = 0, end = 0; begin < ways.size(); ++begin) {
      while (end < ways.size() && ways[end] <= ways[begin] + length)
        ++end;
      if (end == ways.size())
        break;
      const Eigen::Isometry3d error =
          (estimate[begin].inverse() * estimate[end]).inverse() *
          (truth[begin].inverse() * truth[end]);
      ++sum.segments;
      sum.translation += error.translation().norm() / length;
      sum.rotation += Eigen::AngleAxisd(error.linear()).angle() / length;
    }
  sum.translation /= double(sum.segments);
  sum.rotation /= double(sum.segments);
  return sum;
}

} // namespace pcl_semantic
