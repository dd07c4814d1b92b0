// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>

#include <opencv2/core.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Criterion for depth discontinuities within a superpixel. Two neighbouring
 * pixels belong to one surface if their points are near each other, or if the line
 * through both passes the camera at a sufficient distance.
 *
 * At a depth discontinuity the line runs nearly along the rays, so it passes close to
 * the camera. On a plane it never passes closer than the plane itself, at any slant: a
 * road passes at the camera's height, at every range. For stereo, the distance is the
 * baseline divided by the disparity step between the pixels. */
struct DepthJumps {
  double passing_distance = 0.5; ///< minimum distance of the line from the camera [m];
                                 ///< 0 = no discontinuities
  double near = 0.1;             ///< maximum distance of near points [m]

  /** \throws InvalidParameterException unless both are 0 to 1e6 */
  void validate() const;
};

/** \brief Segments of an image without a depth discontinuity inside. */
struct SurfaceParts {
  cv::Mat numbers; ///< CV_32SC1: 0, 1, ... in the order of first pixels; -1 = no depth
  int count = 0;
};

/** \brief Splits the segments of an image at depth discontinuities. Pixels without
 * depth belong to no part; the pixels on both sides of such a gap in a row or column
 * are compared as neighbours if the gap lies in their segment.
 * \param[in] segments CV_32SC1
 * \param[in] cloud organized, of the same size, camera frame [m]
 * \throws BadInputException if the sizes differ, or for another type */
SurfaceParts splitAtDepthJumps(const cv::Mat& segments,
                               const CliqueGenerator::Cloud& cloud,
                               const DepthJumps& jumps);

} // namespace pcl_semantic
