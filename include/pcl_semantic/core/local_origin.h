// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The origin to subtract from double-precision positions before they are
 * converted to single precision, whose steps are half a metre at UTM coordinates.
 *
 * Zero if single precision holds all positions to a tenth of a millimetre (up to a
 * kilometre away). Otherwise near the medians, so that outliers do not matter. The
 * origin avoids round coordinates, because exactly 0 0 0 means that nothing was
 * measured.
 * \param[in] positions 3 x N [m]; non-finite ones are ignored
 * \return in the frame of the positions [m] */
Eigen::Vector3d localOrigin(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/** \brief Positions relative to an origin, in single precision [m]. Two or more
 * positions at exactly 0 0 0 stay there, because nothing was measured at them; see
 * countNoReturns(). */
Eigen::Matrix3Xf relativeTo(const Eigen::Vector3d& origin,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/** \brief Whether a relative position is so far from its origin that single precision
 * has steps of more than a tenth of a millimetre: more than 1024 m along an axis. */
bool isFarOff(const Eigen::Vector3f& relative);

/** \brief Remainders of relative positions, positions - (origin + relative), which
 * single precision does not hold.
 *
 * \param[in] relative of relativeTo() [m]
 * \return 3 x N [m]; empty if no finite position isFarOff(). 0 at 0 0 0 (see
 * relativeTo()) and where a position is not finite */
Eigen::Matrix3Xf remaindersOf(const Eigen::Vector3d& origin,
                              const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                              const Eigen::Matrix3Xf& relative);

/** \brief Whether single precision holds the positions exactly: they were probably
 * single precision before. */
bool areSingle(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

} // namespace pcl_semantic
