// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Where a superpixel ends although the colours go on. Two neighbouring pixels
 * see one surface if their points lie near each other, or if the line through both
 * passes the camera at some distance.
 *
 * The line through the points of neighbouring pixels on either side of a depth edge
 * runs nearly along their rays, so it passes close to the camera; on a plane it passes
 * no nearer than the plane does, however slanted: a road passes at the height of the
 * camera, at every range. In stereo, the distance is the baseline over the disparity's
 * step from pixel to pixel. */
struct DepthJumps {
  double passing_distance = 0.5; ///< of the line to the camera, at least [m]; 0 = no
                                 ///< depth edge is seen
  double near = 0.1;             ///< between the points, at most [m]

  /** \throws InvalidParameterException unless both are 0 to 1e6 */
  void validate() const;
};

/** \brief Parts of an image without a depth edge inside. */
struct SurfaceParts {
  cv::Mat numbers; ///< CV_32SC1: 0, 1, ... in the order of first pixels; -1 = no depth
  int count = 0;
};

/** \brief Splits the segments of an image where they jump in depth. Pixels without
 * depth belong to no part; what lies on both sides of them in a row or a column is
 * compared as if they were neighbours, as long as the segment goes on between.
 * \param[in] segments CV_32SC1
 * \param[in] cloud organized, of the same size, camera frame [m]
 * \throws BadInputException if the sizes or the type do not fit */
SurfaceParts splitAtDepthJumps(const cv::Mat& segments,
                               const CliqueGenerator::Cloud& cloud,
                               const DepthJumps& jumps);

} // namespace pcl_semantic
