// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/yaml_config.h>
#include <pcl_semantic/pipeline/listed_labels.h>
#include <pcl_semantic/pipeline/tuning_grid.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

// The texts under a key, and whether they are candidates rather than one value.
std::vector<std::string>
textsOf(const YamlMap& file, const ConfigParameter& parameter, bool& is_list)
{
  std::vector<std::string> texts;
  is_list = true;
  try {
    texts = file.require<std::vector<std::string>>(parameter.name);
  }
  catch (const BadInputException&) {
    is_list = false;
    return {file.require<std::string>(parameter.name)};
  }
  const bool is_triple = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
  if (is_triple && texts.size() == 3 && texts[0].find(',') == std::string::npos) {
    is_list = false;
    return {texts[0] + "," + texts[1] + "," + texts[2]};
  }
  if (texts.empty())
    PCL_THROW_EXCEPTION(BadInputException, file.where(parameter.name)
                                               << ": no candidates for '"
                                               << parameter.name << "'");
  return texts;
}

ConfigParameter
parameterOf(MapperConfig& config, const std::string& name)
{
  for (ConfigParameter& parameter : parametersOf(config))
    if (parameter.name == name)
      return parameter;
  PCL_THROW_EXCEPTION(InvalidParameterException, "no parameter is called " << name);
}

// Sets a parameter and gives its value as this module writes it: 0.10 is 0.1.
std::string
setParameter(MapperConfig& config, const std::string& name, const std::string& text,
             const LabelSet& label_set, const std::string& where)
{
  ConfigParameter parameter = parameterOf(config, name);
  parameter.set(text, where);
  try {
    MapperConfig copy = config;
    copy.validate();
    listedLabels(copy.clique_leaves_out, label_set, "clique_leaves_out");
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, where << ": " << error.what());
  }
  return parameter.text();
}

TuningAxis
makeAxis(const MapperConfig& start, const std::string& name,
         const std::vector<std::string>& texts, const LabelSet& label_set,
         const std::string& where)
{
  TuningAxis axis;
  axis.name = name;
  MapperConfig config = start;
  const ConfigParameter parameter = parameterOf(config, name);
  const std::string first = parameter.text();
  axis.is_number = std::holds_alternative<double*>(parameter.value) ||
                   std::holds_alternative<int*>(parameter.value);
  axis.candidates.push_back(first);
  for (const std::string& text : texts) {
    MapperConfig with = start;
    const std::string value = setParameter(with, name, text, label_set, where);
    if (!std::count(axis.candidates.begin(), axis.candidates.end(), value))
      axis.candidates.push_back(value);
  }
  if (axis.is_number)
    std::sort(axis.candidates.begin(), axis.candidates.end(),
              [&](const std::string& a, const std::string& b) {
                return parseNumber(a, where) < parseNumber(b, where);
              });
  axis.start =
      std::size_t(std::find(axis.candidates.begin(), axis.candidates.end(), first) -
                  axis.candidates.begin());
  return axis;
}

} // namespace

std::vector<double>
TuningAxis::numbers() const
{
  std::vector<double> numbers;
  for (const std::string& text : candidates)
    numbers.push_back(parseNumber(text, name));
  return numbers;
}

TuningChoice
TuningGrid::startChoice() const
{
  TuningChoice choice;
  for (const TuningAxis& axis : axes)
    choice.push_back(axis.start);
  return choice;
}

MapperConfig
TuningGrid::config(const TuningChoice& choice) const
{
  MapperConfig config = start;
  for (std::size_t i = 0; i < axes.size(); ++i)
    parameterOf(config, axes[i].name)
        .set(axes[i].candidates.at(choice.at(i)), axes[i].name);
  return config;
}

bool
TuningGrid::isPossible(const TuningChoice& choice) const
{
  try {
    config(choice).validate();
  }
  catch (const InvalidParameterException&) {
    return false;
  }
  return true;
}

TuningGrid
readTuningGrid(const std::string& path, const MapperConfig& start,
               const LabelSet& label_set)
{
  const YamlMap file = YamlMap::load(path);
  TuningGrid grid{start, {}};
  MapperConfig names;
  for (const ConfigParameter& parameter : parametersOf(names))
    file.has(parameter.name);
  file.refuseUnknownKeys();
  std::vector<std::pair<std::string, std::vector<std::string>>> lists;
  for (const std::string& key : file.keys()) {
    bool is_list = false;
    const auto texts = textsOf(file, parameterOf(names, key), is_list);
    if (is_list)
      lists.emplace_back(key, texts);
    else
      setParameter(grid.start, key, texts[0], label_set, file.where(key));
  }
  // After all fixed values, with which a candidate has to go.
  for (const auto& [name, texts] : lists)
    grid.axes.push_back(makeAxis(grid.start, name, texts, label_set, file.where(name)));
  if (grid.axes.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": no parameter has a list of candidates");
  return grid;
}

} // namespace pcl_semantic
