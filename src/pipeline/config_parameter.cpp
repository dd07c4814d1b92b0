// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/config_parameter.h>

#include "core/fail.h"
#include "core/split.h"
#include "files/yaml_config.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace pcl_semantic {

namespace {

template <typename... Visitors> struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors> Overloaded(Visitors...) -> Overloaded<Visitors...>;

int
parseInteger(const std::string& text, const std::string& where)
{
  const double value = parseNumber(text, where);
  if (value != std::floor(value) || std::abs(value) > 1e9)
    badInput(where, ": '", text, "' is no integer up to 1e9");
  return static_cast<int>(value);
}

Eigen::Vector3d
parseVector(std::string text, const std::string& where)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3)
    badInput(where, ": '", text, "' is no X,Y,Z triple");
  return {numbers[0], numbers[1], numbers[2]};
}

std::string
printNumber(double value)
{
  TextStream text;
  text << value;
  return text.str();
}

int
parseChoice(const std::string& text, const std::vector<std::string>& words,
            const std::string& where)
{
  const auto word = std::find(words.begin(), words.end(), text);
  if (word == words.end())
    badInput(where, ": '", text, "', expected ", joinWords(words));
  return int(word - words.begin());
}

// The text of a value in a YAML file; a triple may also be written as a list.
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

// Parameters of earlier versions and their names now; empty = removed.
const std::map<std::string, std::string> removed_parameters = {
    {"clique_appearance_deviation", ""},
    {"clique_colour_deviation", ""},
    {"clique_exclude_threshold", ""},
    {"clique_hears_members", "clique_update_from_members"},
    {"clique_leaves_out", "clique_exclude"},
    {"clique_leaves_out_above", ""},
    {"clique_map_messages", ""},
    {"clique_members_hear_map", ""},
    {"clique_smoothness_deviation", ""},
    {"clique_smoothness_weight", ""},
    {"crf_radius", ""},
    {"crf_settled", ""},
    {"crf_tolerance", ""},
    {"hit_share", "min_hit_ratio"},
    {"superpixel_compactness", ""},
    {"supervoxel_colour_weight", ""},
    {"supervoxel_normal_weight", ""},
    {"supervoxel_resolution", "voxel_size"},
    {"supervoxel_spatial_weight", ""}};

} // namespace

std::string
ConfigParameter::option() const
{
  std::string option = name;
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

std::string
ConfigParameter::text() const
{
  return std::visit(
      Overloaded{[](const bool* v) { return std::string(*v ? "true" : "false"); },
                 [](const ConfigChoice& v) { return v.words.at(std::size_t(v.get())); },
                 [](const int* v) { return std::to_string(*v); },
                 [](const double* v) { return printNumber(*v); },
                 [](const std::string* v) { return *v; },
                 [](const Eigen::Vector3d* v) {
                   return printNumber(v->x()) + "," + printNumber(v->y()) + "," +
                          printNumber(v->z());
                 }},
      value);
}

void
ConfigParameter::set(const std::string& text, const std::string& where)
{
  std::visit(Overloaded{[&](bool* v) {
                          *v = parseChoice(text, {"false", "true"}, where) == 1;
                        },
                        [&](const ConfigChoice& v) {
                          v.set(parseChoice(text, v.words, where));
                        },
                        [&](int* v) { *v = parseInteger(text, where); },
                        [&](double* v) { *v = parseNumber(text, where); },
                        [&](std::string* v) { *v = text; },
                        [&](Eigen::Vector3d* v) { *v = parseVector(text, where); }},
             value);
}

std::string
joinWords(const std::vector<std::string>& words)
{
  std::string joined;
  for (std::size_t i = 0; i < words.size(); ++i)
    joined += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return joined;
}

std::string
whyRemoved(const std::string& name)
{
  const auto removed = removed_parameters.find(name);
  if (removed == removed_parameters.end())
    return {};
  return removed->second.empty() ? "had no effect, removed"
                                 : "is " + removed->second + " now";
}

void
readParameters(const std::string& path, ConfigParameters parameters)
{
  const YamlMap file = YamlMap::load(path);
  for (ConfigParameter& parameter : parameters) {
    const bool is_triple = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    if (file.has(parameter.name))
      parameter.set(yamlText(file, parameter.name, is_triple),
                    file.where(parameter.name));
  }
  for (const std::string& key : file.keys())
    if (const std::string why = whyRemoved(key); !why.empty())
      badInput(file.where(key), ": ", key, ": ", why);
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
