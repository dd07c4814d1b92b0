/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_set.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief The classes that --label-set names; empty = the eleven of KITTI.
 * \throws BadInputException as readLabelSet() */
LabelSet readLabelSetOrDefault(const std::string& path);

} // namespace pcl_semantic::tool
