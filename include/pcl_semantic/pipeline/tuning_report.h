// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/tuner.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief All choices that were looked at, one a row, the best first: tab-separated
 * values of the parameters, then scores of all sequences and of each, in percent. */
std::string tuningTable(const Tuner& tuner);

/** \brief What the search found, as Markdown: the chosen values, scores of the start,
 * of the choice, and held out, pooled and by sequence, and the classes.
 * \param[in] data what the runs were made from, one "name: value" a line */
std::string tuningReport(const Tuner& tuner, const LabelSet& label_set,
                         const std::string& data);

/** \brief How the score depends on each parameter, the others as chosen: a panel a
 * parameter, on all sequences and held out. \return CV_8UC3 (BGR) */
cv::Mat drawSensitivity(const Tuner& tuner);

/** \brief Writes best.yaml, table.tsv, report.md and sensitivity.png.
 * \throws OutputException */
void writeTuning(const std::string& folder, const Tuner& tuner,
                 const LabelSet& label_set, const std::string& data);

} // namespace pcl_semantic
