// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

using ThreadLimit = void (*)(int threads);

/** \brief Makes setNumberOfThreads() limit the threads of another library too. Higher
 * libraries register at load time. \return true */
bool addThreadLimit(ThreadLimit limit);

} // namespace pcl_semantic
