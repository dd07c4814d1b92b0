// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace pcl_semantic {

/** \brief Replaces values by -log(max(value, smallest)), to two units in the last
 * place. Cephes' logf without fused products, for identical bits on all platforms:
 * Eigen's log is fused on ARM64 but not on x86-64.
 *
 * \param[in] smallest at least the smallest normal number */
void negateLogs(float* values, std::size_t count, float smallest);

} // namespace pcl_semantic
