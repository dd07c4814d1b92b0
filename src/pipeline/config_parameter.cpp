// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/yaml_config.h>
#include <pcl_semantic/pipeline/config_parameter.h>

#include <algorithm>
#include <cmath>
#include <sstream>

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
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": '" << text << "' is no integer up to 1e9");
  return static_cast<int>(value);
}

Eigen::Vector3d
parseVector(std::string text, const std::string& where)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": '" << text << "' is no X,Y,Z triple");
  return {numbers[0], numbers[1], numbers[2]};
}

std::string
printNumber(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

int
parseChoice(const std::string& text, const std::vector<std::string>& words,
            const std::string& where)
{
  const auto word = std::find(words.begin(), words.end(), text);
  if (word == words.end())
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": '" << text << "', expected " << joinWords(words));
  return int(word - words.begin());
}

bool
parseBool(const std::string& text, const std::string& where)
{
  return parseChoice(text, {"false", "true"}, where) == 1;
}

// The text of a value in a YAML file; a triple may also be written as a list.
std::string
yamlText(const YamlMap& file, const ConfigParameter& parameter)
{
  if (!std::holds_alternative<Eigen::Vector3d*>(parameter.value))
    return file.require<std::string>(parameter.name);
  std::vector<std::string> items;
  try {
    items = file.require<std::vector<std::string>>(parameter.name);
  }
  catch (const BadInputException&) {
    return file.require<std::string>(parameter.name);
  }
  std::string text;
  for (const std::string& item : items)
    text += item + " ";
  return text;
}

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
  std::visit(Overloaded{[&](bool* v) { *v = parseBool(text, where); },
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

void
readParameters(const std::string& path, ConfigParameters parameters)
{
  const YamlMap file = YamlMap::load(path);
  for (ConfigParameter& parameter : parameters)
    if (file.has(parameter.name))
      parameter.set(yamlText(file, parameter), file.where(parameter.name));
  file.refuseUnknownKeys();
}

std::string
printParameters(const ConfigParameters& parameters)
{
  std::ostringstream text;
  for (const ConfigParameter& parameter : parameters) {
    const bool is_list = std::holds_alternative<Eigen::Vector3d*>(parameter.value);
    text << parameter.name << ": "
         << (is_list ? "[" + parameter.text() + "]" : parameter.text()) << "  # "
         << parameter.help << "\n";
  }
  return text.str();
}

} // namespace pcl_semantic
