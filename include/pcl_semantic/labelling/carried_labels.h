// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/labelling/visible_points.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Transfers the class distributions of an image to the points visible in its
 * camera. A visible point gets the distribution of its pixel; other points are
 * unlabelled.
 * \param[in] image L x (width * height), pixels row by row
 * \param[in] camera with its image size
 * \param[in] seen result of seenPoints() with that camera
 * \return L x points
 * \throws InvalidParameterException if \a image has not one column per pixel of the
 * camera, or a seen point is outside the image */
LabelDistributions carryLabels(const LabelDistributions& image,
                               const StereoCamera& camera,
                               const std::vector<SeenPoint>& seen);

} // namespace pcl_semantic
