/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <cstddef>

namespace pcl_semantic {

/** \brief Cost of a row that only fills up a column: its probability is zero. */
constexpr float kPaddingCost = 1e30f;

/** \brief marginals = columns of exp(messages - costs) that sum to one; messages = 0.
 * \param[in] costs of the rows; kPaddingCost in padding
 * \param[in,out] messages, finite, read and cleared
 * \param[in,out] marginals the old ones are compared with the new ones
 * \param[in] columns how many
 * \param[in] stride rows of a column: 8 or a multiple of 16
 * \return the largest change of a marginal */
float softMax(const float* costs, float* messages, float* marginals,
              std::size_t columns, std::size_t stride);

} // namespace pcl_semantic
