// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic {

/** \brief The file of the paper's label set, and the option that names it. */
inline const std::string kitti11 =
    PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml";
inline const std::string of_kitti11 = " --label-set " + kitti11 + " ";

} // namespace pcl_semantic
