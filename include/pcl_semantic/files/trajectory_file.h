/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Poses as KITTI writes them: row = frame number, camera 0 (x right, y down,
 * z forward) in the frame of the first camera 0 [m]. */
using Trajectory = std::vector<Eigen::Isometry3d>;

/** \brief Reads a KITTI trajectory: 12 numbers a row, the upper 3 x 4 of
 * T_first_camera.
 *
 * Rotations off by rounding are made orthonormal again, by more than 1e-2 refused.
 * \throws BadInputException with the line, at a wrong count, a non-finite number or a
 * matrix that is no rotation */
Trajectory readKittiTrajectory(const std::string& path);

/** \brief Writes a KITTI trajectory, so that reading it gives the same numbers.
 * \throws OutputException */
void writeKittiTrajectory(const std::string& path, const Trajectory& trajectory);

} // namespace pcl_semantic
