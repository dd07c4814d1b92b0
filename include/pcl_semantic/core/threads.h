// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Sets the number of threads that this library and OpenCV use for the loops of
 * the calling thread. Results do not depend on it.
 * \param[in] threads 0 = all processors
 * \throws InvalidParameterException if it is negative or exceeds 1024 */
void setNumberOfThreads(int threads);

/** \brief Sets the number of threads until the end of the scope. */
class ThreadScope {
public:
  /** \param[in] threads as setNumberOfThreads(); nullopt = unchanged
   * \throws InvalidParameterException as setNumberOfThreads() */
  explicit ThreadScope(std::optional<int> threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

private:
  int before_;
};

} // namespace pcl_semantic
