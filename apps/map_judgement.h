// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic::tool {

/** \brief What is said at the end of a map that went not quite as it should: warnings,
 * in the order of the functions. */

/** \brief Warns of poses that are predicted. \param[in] sequence its name
 * \throws BadInputException if no frame but the first, which is the origin, could be
 * tracked */
void judgeTracking(const std::string& sequence, int lost, int frames);

void judgeCalibration(const std::string& calibration, double domain_shift);

void warnOfEmptyMap();

} // namespace pcl_semantic::tool
