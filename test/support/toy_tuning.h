// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/pipeline/tuner.h>

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief A search in which a run is a formula: how many of 1000 pixels of class 1 are
 * right, the others are taken for class 2. With class 1 alone the score of a sequence
 * is a tenth of that. */
struct ToyTuning {
  using Right =
      std::function<int(double smoothness, double appearance, std::size_t sequence)>;

  explicit ToyTuning(Right formula) : right(std::move(formula))
  {
    grid.start.crf_parameters.smoothness_weight = 2.0;
    grid.start.crf_parameters.appearance_weight = 2.0;
    grid.axes = {{"smoothness_weight", {"0", "1", "2", "3", "4"}, 2, true},
                 {"appearance_weight", {"0", "1", "2", "3"}, 2, true}};
    options.score.classes = {1};
    options.margin = 0.0;
    options.workers = 2;
  }

  static TuningResult
  resultOf(int right)
  {
    TuningResult result(2);
    for (TuningCounts* const counts : {&result.at_depth, &result.rendered}) {
      counts->refined.add(1, 1, std::uint64_t(right));
      counts->refined.add(1, 2, std::uint64_t(1000 - right));
    }
    return result;
  }

  Tuner
  make(TuningStore& store)
  {
    return {grid,
            names,
            2,
            [this](const MapperConfig& config, std::size_t sequence) {
              const double a = config.crf_parameters.smoothness_weight;
              const double b = config.crf_parameters.appearance_weight;
              const std::lock_guard<std::mutex> lock(counting);
              ++runs[{{a, b}, sequence}];
              return resultOf(right(a, b, sequence));
            },
            store,
            options};
  }

  Right right;
  TuningGrid grid;
  std::vector<std::string> names = {"one", "two", "three"};
  TuningOptions options;
  std::mutex counting;
  std::map<std::pair<std::pair<double, double>, std::size_t>, int> runs;
};

} // namespace pcl_semantic
