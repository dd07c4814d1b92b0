// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Scores as an aligned table of text, figures in percent. */
std::string scoresTable(const Scores& scores, const LabelSet& label_set);

/** \brief The two header lines that belong to scoresMarkdownRow. */
std::string scoresMarkdownHeader(const Scores& scores, const LabelSet& label_set);

/** \brief One row of a Markdown table in percent: name, exclusive IoU of each class and
 * their mean, global accuracy, mean inclusive IoU, coverage; "-" for what is not there.
 */
std::string scoresMarkdownRow(const Scores& scores, const std::string& name);

/** \brief Scores as JSON; ratios are 0..1, null where there is none. */
std::string scoresJson(const Scores& scores, const LabelSet& label_set);

/** \brief All counts as CSV: a row a true label, a column a predicted one. */
std::string confusionCsv(const ConfusionMatrix& confusion, const LabelSet& label_set);

} // namespace pcl_semantic
