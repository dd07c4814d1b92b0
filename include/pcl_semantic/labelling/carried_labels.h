// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/labelling/visible_points.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Carries the class distributions of an image onto the points that its camera
 * sees: each has that of its pixel, the others are unlabelled.
 * \param[in] image L x (width * height), pixels row by row
 * \param[in] camera with its image size
 * \param[in] seen of seenPoints() with that camera
 * \return L x points
 * \throws InvalidParameterException if the sizes do not fit */
LabelDistributions carryLabels(const LabelDistributions& image,
                               const StereoCamera& camera,
                               const std::vector<SeenPoint>& seen);

} // namespace pcl_semantic
