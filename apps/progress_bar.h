// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace pcl_semantic::tool {

/** \brief A progress bar on standard error: only on a terminal, not with --quiet, and
 * only for work that takes longer than a second. With --verbose a note a step. */
class ProgressBar {
public:
  /** \param[in] what "mapping"
   * \param[in] total number of steps
   * \param[in] unit of a step */
  ProgressBar(std::string what, std::size_t total, std::string unit = "frames");
  ~ProgressBar();

  /** \brief One step is done; draws ten times a second. */
  void step();

private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::size_t total_;
  std::string unit_;
  std::size_t done_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_ + std::chrono::seconds(1);
  bool terminal_;
};

} // namespace pcl_semantic::tool
