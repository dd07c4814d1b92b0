// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Parameters without effect at a value of another parameter. */
struct UnreadParameters {
  bool holds;
  std::string because; ///< the other parameter: "crf"
  std::string value;   ///< value of the other parameter
  std::vector<std::string> names;
};

/** \brief Unread parameters of a CRF, by their names in YAML files.
 * \param[in] model "none" or "unary", "dense", "pn-potts" or "hierarchical"
 * \param[in] cliques value of the parameter `cliques` */
inline std::vector<UnreadParameters>
unreadParametersOfCRF(const std::string& model, const std::string& cliques)
{
  const bool is_off = model == "none" || model == "unary";
  const bool has_cliques = model == "pn-potts" || model == "hierarchical";
  return {{is_off,
           "crf",
           model,
           {"crf_iterations", "crf_sensor", "crf_temperature", "crf_keep_thin",
            "crf_logit_adjustment", "crf_normalization", "crf_every",
            "smoothness_weight", "smoothness_deviation", "appearance_weight",
            "appearance_deviation", "colour_deviation"}},
          {!has_cliques,
           "crf",
           model,
           {"cliques", "superpixel_depth_jump", "clique_weight", "clique_start"}},
          {model != "hierarchical",
           "crf",
           model,
           {"clique_free_label", "clique_truncation", "clique_appearance_weight"}},
          {cliques.find("superpixel") == std::string::npos,
           "cliques",
           cliques,
           {"superpixel_depth_jump"}}};
}

} // namespace pcl_semantic
