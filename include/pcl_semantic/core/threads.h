// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Sets how many threads this module and OpenCV use from now on, for the calling
 * thread's loops; results do not depend on it.
 * \param[in] threads 0 = all processors
 * \throws InvalidParameterException if it is negative or beyond 1024 */
void setNumberOfThreads(int threads);

/** \brief Sets it until the end of a block: how objects have a number of their own. */
class ThreadScope {
public:
  /** \param[in] threads as setNumberOfThreads(); nothing leaves it as it is
   * \throws InvalidParameterException as setNumberOfThreads() */
  explicit ThreadScope(std::optional<int> threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

private:
  int before_;
};

} // namespace pcl_semantic
