// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/config_file.h>

#include "yaml_parameters.h"

#include "core/fail.h"
#include "core/text_stream.h"

#include <map>
#include <utility>
#include <variant>
#include <vector>

namespace pcl_semantic {

namespace {

// The text of a value in a YAML file; a triple may also be a list.
std::string
yamlText(const YamlMap& file, const std::string& key, bool is_triple)
{
  if (!is_triple)
    return file.require<std::string>(key);
  std::vector<std::string> items;
  try {
    items = file.require<std::vector<std::string>>(key);
  }
  catch (const BadInputException&) {
    return file.require<std::string>(key);
  }
  std::string text;
  for (const std::string& item : items)
    text += item + " ";
  return text;
}

// Parameters of earlier versions and their current names; empty = removed.
const std::map<std::string, std::string> removed_parameters = {
    {"clique_appearance_deviation", ""},
    {"clique_colour_deviation", ""},
    {"clique_exclude", ""},
    {"clique_exclude_threshold", ""},
    {"clique_hears_members", ""},
    {"clique_leaves_out", ""},
    {"clique_leaves_out_above", ""},
    {"clique_map_messages", ""},
    {"clique_members_hear_map", ""},
    {"clique_smoothness_deviation", ""},
    {"clique_smoothness_weight", ""},
    {"clique_update_from_members", ""},
    {"crf_radius", ""},
    {"crf_settled", ""},
    {"crf_tolerance", ""},
    {"dynamic_decay", "free_dynamic"},
    {"hit_share", "min_hit_ratio"},
    {"superpixel_compactness", ""},
    {"supervoxel_colour_weight", ""},
    {"supervoxel_normal_weight", ""},
    {"supervoxel_resolution", "voxel_size"},
    {"supervoxel_spatial_weight", ""}};

} // namespace

std::string
whyRemoved(const std::string& name)
{
  const auto removed = removed_parameters.find(name);
  if (removed == removed_parameters.end())
    return {};
  return removed->second.empty() ? "was removed, it had no effect"
                                 : "was renamed to " + removed->second;
}

void
setParameters(const YamlMap& file, ConfigParameters parameters)
{
  for (ConfigParameter& parameter : parameters) {
    const bool is_triple = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    if (file.has(parameter.name))
      parameter.set(yamlText(file, parameter.name, is_triple),
                    file.where(parameter.name));
  }
  for (const std::string& key : file.keys())
    if (const std::string why = whyRemoved(key); !why.empty())
      badInput(file.where(key), ": ", key, ": ", why);
}

void
readParameters(const std::string& path, ConfigParameters parameters)
{
  const YamlMap file = YamlMap::load(path);
  setParameters(file, std::move(parameters));
  file.refuseUnknownKeys();
}

std::string
printParameters(const ConfigParameters& parameters)
{
  TextStream text;
  for (const ConfigParameter& parameter : parameters) {
    if (parameter.text() == parameter.preset_default)
      continue;
    const bool is_list = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    text << parameter.name << ": "
         << (is_list ? "[" + parameter.text() + "]" : parameter.text()) << "  # "
         << parameter.help << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
