// SPDX-License-Identifier: BSD-3-Clause
#include "run_values.h"

#include "core/split.h"

#include <string_view>

namespace pcl_semantic {

std::map<std::string, std::string>
runValues(const std::string& description)
{
  std::map<std::string, std::string> values;
  for (const std::string_view line : splitAt('\n', description)) {
    const std::size_t colon = line.find(": ");
    values[std::string(line.substr(0, colon))] =
        colon == std::string_view::npos ? "" : line.substr(colon + 2);
  }
  return values;
}

void
setFromRun(const std::map<std::string, std::string>& values,
           ConfigParameters parameters)
{
  for (ConfigParameter& parameter : parameters)
    if (const auto value = values.find(parameter.name); value != values.end())
      parameter.set(value->second, parameter.name);
}

} // namespace pcl_semantic
