// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Costs -log p, eq. (4), of some columns of measurements, L x N of any positive
 * scale; one that is all zero has no preference. */
Eigen::MatrixXf unaryCosts(const Eigen::MatrixXf& measured,
                           const std::vector<std::int32_t>& columns);

} // namespace pcl_semantic
