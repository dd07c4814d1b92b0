/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/simd.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Of the same loops in every tier, those of one: functions, or tables of them.
 */
template <typename Loops>
const Loops&
ofTier(SimdTier tier, const Loops& plain, const Loops& avx2, const Loops& avx512)
{
  return tier == SimdTier::avx512 ? avx512 : tier == SimdTier::avx2 ? avx2 : plain;
}

} // namespace pcl_semantic
