// SPDX-License-Identifier: BSD-3-Clause
#include "label_kind.h"

#include "files/is_there.h"
#include "files/report_text.h"
#include "messages.h"

#include <pcl_semantic/pipeline/mapping_output.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic::tool {

namespace fs = std::filesystem;

namespace {

constexpr LabelKind causal{"causal", "labels of the map as it was at each frame"};
constexpr LabelKind finished{"final", "labels of the finished map"};
constexpr LabelKind network{"network", "labels of the network"};

LabelKind
kindOfFolder(const std::string& folder)
{
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename())
    path = path.parent_path();
  const std::string name = path.filename().string();
  const std::vector<std::string>& names = MappingOutput::names();
  if (!isThere((path.parent_path() / "summary.json").string()) ||
      std::find(names.begin(), names.end(), name) == names.end())
    return {};
  if (name.rfind("final_", 0) == 0)
    return finished;
  return name.rfind("network_", 0) == 0 ? network : causal;
}

} // namespace

LabelKind
kindOf(const std::vector<std::string>& folders)
{
  const LabelKind first = kindOfFolder(folders.front());
  for (const std::string& folder : folders)
    if (kindOfFolder(folder).name != first.name) {
      warn("the predictions are not of one kind: " + folders.front() + " and " +
           folder);
      return {};
    }
  return first;
}

std::string
withKind(const LabelKind& kind, const std::string& table)
{
  if (kind.name.empty())
    return table;
  return std::string(kind.name) + ": " + std::string(kind.description) + "\n" + table;
}

std::string
jsonWithKind(const LabelKind& kind, const std::string& json)
{
  if (kind.name.empty())
    return json;
  nlohmann::ordered_json figures = {{"labels", kind.name}};
  figures.update(nlohmann::ordered_json::parse(json));
  return jsonText(figures);
}

} // namespace pcl_semantic::tool
