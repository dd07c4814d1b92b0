// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>

namespace pcl_semantic::kernels {

/** \brief values[i] = -log(max(values[i], smallest)), to two units in the last place:
 * Cephes' logf without fused products, so that every platform gives the same bits
 * (Eigen's log fuses them on ARM64 and does not on x86-64).
 * \param[in] smallest at least the smallest normal number */
using NegativeLogs = void (*)(float* values, std::size_t count, float smallest);

NegativeLogs negativeLogs(SimdTier tier);

} // namespace pcl_semantic::kernels
