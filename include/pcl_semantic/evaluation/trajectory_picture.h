// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Two paths seen from above, forward is up: the first grey, the second red, the
 * beginning a circle, a bar for the scale. The second is moved so that the first poses
 * agree.
 * \return CV_8UC3 (BGR)
 * \throws InvalidParameterException if one is empty */
cv::Mat drawTrajectories(const Trajectory& first, const Trajectory& second,
                         int size = 800);

} // namespace pcl_semantic
