// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "street.h"

#include <vector>

namespace pcl_semantic::synthetic {

/** \brief Makes all objects along a road: buildings and their fences, hedges and trees,
 * parked cars, lamp posts, signs, people.
 * \param[in] length of the built part of the road [m] */
std::vector<Primitive> buildStreet(const RoadLine& road, double length,
                                   std::uint32_t seed);

} // namespace pcl_semantic::synthetic
