// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The origin that is taken off positions of double precision before anything is
 * computed of them in single precision, which has steps of half a metre at UTM
 * coordinates.
 *
 * Zero where single precision holds all positions to a tenth of a millimetre, up to a
 * kilometre away; else beside their medians, so that what lies far from most of them
 * does not matter. No point of a grid of round numbers lies at it: exactly 0 0 0 means
 * that nothing was measured.
 * \param[in] positions 3 x N [m]; those that are not finite are passed over
 * \return as the positions [m] */
Eigen::Vector3d localOrigin(const Eigen::Matrix3Xd& positions);

/** \brief Positions relative to an origin, in single precision [m]. Two or more at
 * exactly 0 0 0 stay there: nothing was measured at them, see countNoReturns(). */
Eigen::Matrix3Xf relativeTo(const Eigen::Vector3d& origin,
                            const Eigen::Matrix3Xd& positions);

/** \brief Whether single precision holds the positions as they are: they are likely to
 * have been of single precision before. */
bool areSingle(const Eigen::Matrix3Xd& positions);

} // namespace pcl_semantic
