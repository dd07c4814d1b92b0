// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>

#include <limits>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Folders of files that bear the same names: label images (`.png`), or labels
 * of the points of scans (`.label`). */
struct EvaluatedFolders {
  std::string prediction, truth;
  std::string covered_by;  ///< empty = all pixels count
  std::string truth_depth; ///< `.png` or `.bin`, see readDepths(); empty = unknown
};

/** \brief Depths from <= z < to [m]. */
struct DepthRange {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
  std::string text; ///< "10-20 m"
};

/** \brief A range "A:B" in metres; what is left out is 0 or infinite.
 * \throws InvalidParameterException unless 0 <= A < B */
DepthRange parseDepthRange(const std::string& text);

/** \brief Compares the files of the folders.
 * \param[in] ranges of the truth's depth; empty = all of it, wherever it is
 * \param[in] mapping of the classes of `.label` ground truth to ours; null = they are
 * ours \return one matrix a range, or one \throws BadInputException that names the
 * files */
std::vector<ConfusionMatrix> compareFolders(const EvaluatedFolders& folders,
                                            const std::vector<DepthRange>& ranges,
                                            const LabelSet& label_set,
                                            const LabelMapping* mapping);

} // namespace pcl_semantic::tool
