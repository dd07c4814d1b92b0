// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "street.h"

#include <vector>

namespace pcl_semantic::synthetic {

/** \brief Makes all objects along a road: buildings and their fences, hedges and trees,
 * parked cars, lamp posts, signs, people.
 * \param[in] length of the built part of the road [m]
 * \param[in] first_object number of the first car; the other cars and the pedestrians
 * have the next numbers */
std::vector<Primitive> buildStreet(const RoadLine& road, double length,
                                   std::uint32_t seed, int first_object = 1);

/** \brief Makes the driving cars in a frame, with the numbers from 1. Cars before the
 * start or beyond the end of the built part are left out.
 * \param[in] length of the built part of the road [m] */
std::vector<Primitive> buildTraffic(const RoadLine& road, double length,
                                    std::uint32_t seed,
                                    const std::vector<DrivingCar>& cars, int frame);

} // namespace pcl_semantic::synthetic
