// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <cstddef>
#include <vector>

namespace pcl_semantic {

/** \brief How often one label became another. */
struct LabelChange {
  Label from = kUnlabelled;
  Label to = kUnlabelled;
  std::size_t count = 0;
};

/** \brief What became of labels: of voxels, or of pixels. */
struct LabelChanges {
  std::size_t compared = 0;       ///< labelled before and after
  std::size_t changed = 0;        ///< of those
  std::vector<LabelChange> kinds; ///< the most frequent first, then by numbers

  std::size_t right = 0; ///< changed to the ground truth
  std::size_t wrong = 0; ///< changed from the ground truth
};

/** \brief Counts where both labels are there and differ.
 * \param[in] truth of the same positions, 0 = not known; empty = none
 * \throws InvalidParameterException unless all have the same length */
LabelChanges countLabelChanges(const std::vector<Label>& before,
                               const std::vector<Label>& after,
                               const std::vector<Label>& truth = {});

} // namespace pcl_semantic
