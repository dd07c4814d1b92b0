// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface.h"

#include <Eigen/Core>

#include <cstdint>

namespace pcl_semantic::synthetic {

/** \brief Light of the sky in a unit direction, world axes; linear, 0..1. */
Eigen::Vector3f skyColour(const Eigen::Vector3d& direction, std::uint32_t seed);

/** \brief Reflectance of a surface: red, green, blue, linear, 0..1.
 * \param[in] footprint width of a pixel on the surface [m]; finer structure is
 * omitted */
Eigen::Vector3f surfaceColour(const Surface& surface, double footprint,
                              std::uint32_t seed);

} // namespace pcl_semantic::synthetic
