// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <mutex>

namespace pcl_semantic {

/** \brief Carries an exception out of an OpenMP region, which none may leave by itself:
 * a lack of memory in a thread would end the program. */
class ParallelGuard {
public:
  /** \brief Runs a part of the region that may throw; keeps one of the exceptions. */
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

  /** \brief To be called after the region: throws what was kept, if anything. */
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
