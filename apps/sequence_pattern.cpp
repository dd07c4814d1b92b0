// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_pattern.h"

#include <filesystem>

namespace pcl_semantic::tool {

std::string
filledIn(const std::string& pattern, const std::string& sequence)
{
  const std::string name =
      (std::filesystem::path(sequence) / "").parent_path().filename().string();
  std::string filled;
  for (std::size_t at = 0; at < pattern.size();) {
    const bool is_path = pattern.compare(at, 10, "{sequence}") == 0;
    const bool is_name = pattern.compare(at, 6, "{name}") == 0;
    filled += is_path ? sequence : is_name ? name : pattern.substr(at, 1);
    at += is_path ? 10 : is_name ? 6 : 1;
  }
  return filled;
}

} // namespace pcl_semantic::tool
