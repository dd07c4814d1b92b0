// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief The classes that --label-set names; empty = the eleven of KITTI.
 * \throws BadInputException as readLabelSet() */
LabelSet readLabelSetOrDefault(const std::string& path);

} // namespace pcl_semantic::tool
