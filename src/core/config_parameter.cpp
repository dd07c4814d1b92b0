// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/config_parameter.h>

#include "fail.h"
#include "text_stream.h"

#include <pcl_semantic/core/parse_number.h>

#include <algorithm>
#include <cmath>

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
    badInput(where, ": '", text, "', expected an integer up to 1e9");
  return static_cast<int>(value);
}

Eigen::Vector3d
parseVector(std::string text, const std::string& where)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  const std::vector<double> numbers = parseNumbers(text, where);
  if (numbers.size() != 3)
    badInput(where, ": '", text, "', expected three numbers X,Y,Z");
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

} // namespace pcl_semantic
