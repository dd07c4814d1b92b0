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

/** \brief Counts of the labels of voxels that changed. */
struct LabelChanges {
  std::size_t compared = 0;       ///< labelled before and after
  std::size_t changed = 0;        ///< of those
  std::vector<LabelChange> kinds; ///< the most frequent first, then by numbers
};

/** \brief Counts where both labels are there and differ.
 * \throws InvalidParameterException unless they have the same length */
LabelChanges countLabelChanges(const std::vector<Label>& before,
                               const std::vector<Label>& after);

} // namespace pcl_semantic
