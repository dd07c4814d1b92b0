// SPDX-License-Identifier: BSD-3-Clause
#include "label_changes.h"
#include "core/fail.h"

#include <algorithm>

namespace pcl_semantic {

LabelChanges
countLabelChanges(const std::vector<Label>& before, const std::vector<Label>& after)
{
  if (before.size() != after.size())
    badParameter("labels of ", before.size(), " and ", after.size(), " positions");
  LabelChanges changes;
  std::vector<std::size_t> counts(256 * 256, 0);
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (before[i] == kUnlabelled || after[i] == kUnlabelled)
      continue;
    ++changes.compared;
    if (before[i] == after[i])
      continue;
    ++counts[std::size_t(before[i]) * 256 + after[i]];
  }
  for (std::size_t pair = 0; pair < counts.size(); ++pair)
    if (counts[pair] > 0) {
      changes.changed += counts[pair];
      changes.kinds.push_back({Label(pair / 256), Label(pair % 256), counts[pair]});
    }
  std::stable_sort(
      changes.kinds.begin(), changes.kinds.end(),
      [](const LabelChange& a, const LabelChange& b) { return a.count > b.count; });
  return changes;
}

} // namespace pcl_semantic
