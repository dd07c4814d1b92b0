// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What one update of a dense CRF has to compute anew of a cloud of which a part
 * changed. A changed point reaches the kernel sums of points within the kernel's
 * radius, and through these the results of points within twice the radius. */
struct ChangedRegion {
  std::vector<std::int32_t> points; ///< all that are needed, in rising order
  std::vector<std::uint8_t> fresh;  ///< of these: whether the kernel sum may differ
  std::vector<std::uint8_t> result; ///< of these: whether the result may differ
};

/** \brief Finds the changed region, in blocks of the size of the radius: it may be up
 * to two of them wider than it has to be. \param[in] positions 3 x N \param[in] changed
 * of the N points: 1 = new, or different in what a CRF knows of it \param[in] gone 3 x
 * M, positions of points that are no longer there \param[in] radius of the kernels, in
 * the unit of the positions */
ChangedRegion findChangedRegion(const Eigen::Matrix3Xf& positions,
                                const std::vector<std::uint8_t>& changed,
                                const Eigen::Matrix3Xf& gone, float radius);

} // namespace pcl_semantic
