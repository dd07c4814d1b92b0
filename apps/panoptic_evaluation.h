// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/evaluation/panoptic_quality.h>

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Folders of the scans of sequences, one of each per sequence. Their files have
 * equal names. */
struct ScanFolders {
  std::vector<std::string> truths;      ///< `.label`
  std::vector<std::string> predictions; ///< `.label`
  std::vector<std::string> covered_by;  ///< `.label`; empty = all points count
  std::vector<std::string> scans;       ///< `.bin`; empty = no positions
};

/** \brief Compares the segments of all scans with ground truth.
 * \param[in] mapping of the classes of the ground truth to the label set
 * \param[in] evaluated the classes that count
 * \throws BadInputException that names the file */
PanopticQuality compareSegments(const ScanFolders& folders, const LabelSet& label_set,
                                const PixelMapping& mapping,
                                const std::vector<Label>& evaluated);

/** \brief Formats the scores as aligned text tables, in percent. */
std::string panopticTable(const PanopticQuality& quality,
                          const std::vector<Label>& evaluated,
                          const LabelSet& label_set);

/** \brief Formats the scores as JSON, see doc/things.md; ratios are 0..1, null if
 * undefined. */
std::string panopticJson(const PanopticQuality& quality,
                         const std::vector<Label>& evaluated,
                         const LabelSet& label_set);

} // namespace pcl_semantic::tool
