// SPDX-License-Identifier: BSD-3-Clause
#include "unread_options.h"

#include "core/fail.h"
#include "filters/unread_parameters.h"

#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace pcl_semantic {

void
refuseUnread(const std::set<std::string>& given,
             const std::vector<UnreadOptions>& rules)
{
  for (const UnreadOptions& rule : rules)
    for (const std::string& option : rule.options)
      if (rule.holds && given.count(option) > 0)
        badParameter("--", option, " has no effect ", rule.condition);
}

std::vector<UnreadOptions>
unreadOptionsOfCRF(const std::string& model, const std::string& cliques)
{
  std::vector<UnreadOptions> rules;
  for (UnreadParameters& rule : unreadParametersOfCRF(model, cliques)) {
    for (std::string& name : rule.names)
      std::replace(name.begin(), name.end(), '_', '-');
    rules.push_back({rule.holds, "with --" + rule.because + " " + rule.value,
                     std::move(rule.names)});
  }
  return rules;
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

} // namespace pcl_semantic
