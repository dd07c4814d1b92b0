// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <set>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Options that have no effect where a condition holds. */
struct UnreadOptions {
  bool holds;
  std::string condition; ///< as a message ends: "with --crf none"
  std::vector<std::string> options;
};

/** \brief Refuses options that were given and would have no effect.
 * \throws InvalidParameterException that names the option and the condition */
void refuseUnread(const std::set<std::string>& given,
                  const std::vector<UnreadOptions>& rules);

/** \brief Unread options of a CRF.
 * \param[in] model "none" or "unary", "dense", "pn-potts" or "hierarchical"
 * \param[in] cliques value of `--cliques` */
std::vector<UnreadOptions> unreadOptionsOfCRF(const std::string& model,
                                              const std::string& cliques);

/** \brief Unread options of stored labels that are probabilities.
 * \param[in] labels folder or file; empty = none */
UnreadOptions unreadOptionsOfLabels(const std::string& labels);

} // namespace pcl_semantic
