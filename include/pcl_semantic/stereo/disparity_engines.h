// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/stereo/disparity_estimator.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Names of the engines, the best first: `sgm` (SemiGlobalMatcher), `elas`
 * (Elas) and `sgbm` (Sgbm, OpenCV's). */
const std::vector<std::string>& disparityEngines();

/** \brief An engine with its defaults.
 * \param[in] name one of disparityEngines()
 * \param[in] disparities largest disparity + 1 [px]; a multiple of 16, of 64 for `sgm`
 * \throws InvalidParameterException */
std::unique_ptr<DisparityEstimator> makeDisparityEstimator(const std::string& name,
                                                           int disparities);

} // namespace pcl_semantic
