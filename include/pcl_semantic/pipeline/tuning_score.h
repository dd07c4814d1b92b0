// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Counts of truth pixels, each compared with three predictions. */
struct TuningCounts {
  explicit TuningCounts(int classes)
      : network(classes), fused(classes), refined(classes)
  {}

  ConfusionMatrix network; ///< of the 2D network, on the pixels that are covered
  ConfusionMatrix fused;   ///< of the map before the CRF
  ConfusionMatrix refined; ///< of the map

  TuningCounts& operator+=(const TuningCounts& other);
};

/** \brief What a configuration does on one sequence, or on several: pooling is adding.
 */
struct TuningResult {
  explicit TuningResult(int classes) : at_depth(classes), rendered(classes) {}

  TuningCounts at_depth; ///< voxel at each pixel's own measured depth
  TuningCounts rendered; ///< the map's voxels drawn, the nearest first

  TuningResult& operator+=(const TuningResult& other);
};

/** \brief What makes one configuration better than another. */
struct TuningScore {
  enum class Kind {
    exclusive, ///< mean exclusive IoU
    inclusive, ///< mean inclusive IoU
    gain       ///< mean exclusive IoU, less that of the network on the same pixels
  };
  enum class View { both, depth, rendered }; ///< both: the mean of the two

  Kind kind = Kind::exclusive;
  View view = View::both;
  std::vector<Label> classes; ///< that count

  /** \return in percent; -infinity if there is nothing to score */
  double operator()(const TuningResult& result) const;

  /** \brief "mean exclusive IoU, at depth and rendered". */
  std::string describe() const;
};

/** \brief All classes but sky, pedestrian and cyclist, as far as they are there. */
std::vector<Label> classesThatCount(const LabelSet& label_set);

} // namespace pcl_semantic
