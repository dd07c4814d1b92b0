// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Sets how many threads this module and OpenCV use from now on, for the calling
 * thread's loops; results do not depend on it.
 * \param[in] threads 0 = all processors
 * \throws InvalidParameterException if it is negative or beyond 1024 */
void setNumberOfThreads(int threads);

} // namespace pcl_semantic
