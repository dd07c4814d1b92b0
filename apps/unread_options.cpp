// SPDX-License-Identifier: BSD-3-Clause
#include "unread_options.h"

#include <pcl_semantic/files/input_file.h>

#include <filesystem>

namespace pcl_semantic::tool {

void
refuseUnread(const po::variables_map& values, const std::vector<UnreadOptions>& rules)
{
  for (const UnreadOptions& rule : rules)
    for (const std::string& option : rule.options)
      refuseIf(rule.holds && values.count(option) && !values[option].defaulted(),
               "--" + option + " has no effect " + rule.condition);
}

std::vector<UnreadOptions>
unreadOptionsOfCRF(const std::string& model, const std::string& cliques)
{
  const bool is_off = model == "none" || model == "unary";
  const bool has_cliques = model == "pn-potts" || model == "hierarchical";
  const std::string with = "with --crf " + model;
  return {{is_off,
           with,
           {"crf-iterations", "crf-temperature", "crf-keep-thin", "crf-normalization",
            "crf-every", "smoothness-weight", "smoothness-deviation",
            "appearance-weight", "appearance-deviation", "colour-deviation"}},
          {!has_cliques,
           with,
           {"cliques", "clique-exclude", "superpixel-depth-jump", "clique-weight"}},
          {model != "hierarchical",
           with,
           {"clique-free-label", "clique-truncation", "clique-update-from-members",
            "clique-appearance-weight", "clique-calibration"}},
          {cliques.rfind("superpixel", 0) != 0,
           "with --cliques " + cliques,
           {"superpixel-depth-jump"}}};
}

UnreadOptions
unreadOptionsOfLabels(const std::string& labels)
{
  std::error_code error;
  const bool are_numbers = std::filesystem::is_directory(labels, error)
                               ? !listFrameFiles(labels, {".png"}).empty()
                               : std::filesystem::path(labels).extension() == ".png";
  return {!labels.empty() && !are_numbers && std::filesystem::exists(labels, error),
          "with " + labels + ", which holds probabilities",
          {"label-mapping", "label-confidence"}};
}

} // namespace pcl_semantic::tool
