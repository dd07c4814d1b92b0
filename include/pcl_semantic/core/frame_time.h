// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Number and timestamp of a frame in a sequence. */
struct FrameTime {
  int number = 0;         ///< may have gaps
  double timestamp = 0.0; ///< [s]
};

} // namespace pcl_semantic
