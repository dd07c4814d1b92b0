// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Seconds of each stage of one frame, in the order they ran. */
class StageTimes {
public:
  /** \brief Runs a stage and keeps its wall time. \return what \a stage returns */
  template <typename Stage>
  auto
  measure(const std::string& name, Stage&& stage)
  {
    const Stopwatch stopwatch{*this, name, Clock::now()};
    return stage();
  }

  const std::vector<std::pair<std::string, double>>&
  seconds() const
  {
    return seconds_;
  }

private:
  using Clock = std::chrono::steady_clock;

  struct Stopwatch {
    StageTimes& times;
    const std::string& name;
    Clock::time_point start;

    ~Stopwatch()
    {
      times.seconds_.emplace_back(
          name, std::chrono::duration<double>(Clock::now() - start).count());
    }
  };

  std::vector<std::pair<std::string, double>> seconds_;
};

} // namespace pcl_semantic
