// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "synthetic_street.h"

namespace pcl_semantic::synthetic {

/** \brief Reflectance of a surface: red, green, blue, linear, 0..1.
 * \param[in] footprint width of a pixel on the surface [m]; finer structure is left out
 */
Eigen::Vector3f surfaceColour(const Surface& surface, double footprint,
                              std::uint32_t seed);

} // namespace pcl_semantic::synthetic
