// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <mutex>

namespace pcl_semantic {

/** \brief Carries an exception out of an OpenMP region. An exception that leaves the
 * region itself, such as std::bad_alloc, would terminate the program. */
class ParallelGuard {
public:
  /** \brief Runs a part of the region that may throw; keeps one exception. */
  template <typename Body>
  void
  run(Body&& body) noexcept
  {
    try {
      body();
    }
    catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      error_ = std::current_exception();
    }
  }

  /** \brief Throws the kept exception, if any; call it after the region. */
  void
  rethrow() const
  {
    if (error_)
      std::rethrow_exception(error_);
  }

private:
  std::mutex mutex_;
  std::exception_ptr error_;
};

} // namespace pcl_semantic
