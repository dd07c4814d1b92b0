// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>

#include <opencv2/core.hpp>

namespace pcl_semantic {

/** \brief The colours of an organized cloud: CV_8UC3 (BGR).
 * \throws BadInputException if it has points and is not organized */
cv::Mat imageOf(const CliqueGenerator::Cloud& cloud);

} // namespace pcl_semantic
