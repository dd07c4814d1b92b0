// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/crf_config.h>

#include "core/text_stream.h"
#include "files/unread_options.h"

#include <boost/program_options.hpp>

#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic::tool {

namespace po = boost::program_options;

/** \brief Texts of a tool's `--help`. */
struct Usage {
  std::string name;        ///< "pcl_semantic_map"
  std::string synopsis;    ///< "SEQUENCE --output DIR [options]"
  std::string description; ///< one or two sentences
  std::string example;     ///< a command that works when pasted
  /// Options in `--help`, if all options do not fit on a screen: an option with its
  /// value ("labels DIR"), and a line of help. `--help-all` lists all options.
  std::vector<std::pair<std::string, std::string>> often{};
};

/** \brief An option of a tool: name ("output,o"), target of its value, help. */
struct Option {
  /** \brief An optional value, or several for a std::vector; the help shows no
   * default. */
  template <typename T>
  Option(const std::string& name, T& value, std::string help)
      : Option(name, po::value(&value), std::move(help))
  {}

  /** \brief A switch. */
  Option(const std::string& name, bool& value, std::string help)
      : Option(name, po::bool_switch(&value), std::move(help))
  {}

  /** \brief Another kind of value: required(...), withDefault(...). */
  Option(std::string name, const po::value_semantic* value, std::string help)
      : names(std::move(name)), target(value), text(std::move(help))
  {}

  std::string names;
  const po::value_semantic* target;
  std::string text;
};

/** \brief A required value. */
template <typename T>
po::typed_value<T>*
required(T& value)
{
  return po::value(&value)->required();
}

/** \brief Formats a value for the help: 0.7, not 0.69999999999999996. */
template <typename T>
std::string
shown(const T& value)
{
  TextStream text;
  text << value;
  return text.str();
}

/** \brief A value whose current content is the default, shown in the help. */
template <typename T>
po::typed_value<T>*
withDefault(T& value)
{
  return po::value<T>(&value)->default_value(value, shown(value));
}

/** \brief Makes options of inputs: a `bool` becomes a switch, and defaults are
 * shown. */
std::vector<Option> optionsOf(const ConfigParameters& parameters);

/** \brief Parses the command line. Adds `--help`, `--help-all`, `--version` and
 * `--man`, which end the tool, and `--quiet`, `--verbose` and `--json`, which set
 * manner().
 * \param[in] options in the order of the help
 * \param[in] positional options without a name; a last one "files..." takes the rest
 * \param[in] parameters additional options, see setParameters()
 * \throws Exit if help was printed
 * \throws InvalidParameterException at unknown options, missing or unreadable values */
po::variables_map parseCommandLine(int argc, char** argv, const Usage& usage,
                                   const std::vector<Option>& options,
                                   const std::vector<std::string>& positional = {},
                                   const ConfigParameters& parameters = {});

/** \brief Sets the parameters whose options were given.
 * \throws InvalidParameterException if a value cannot be read */
void setParameters(const po::variables_map& values, ConfigParameters parameters);

/** \brief Sets a CRF: first from \a file (YAML; empty = none), then from the given
 * options.
 * \param[in] print the result, as YAML, and end the tool
 * \throws Exit if it was printed
 * \throws InvalidParameterException, BadInputException */
void setCRFConfig(const po::variables_map& values, const std::string& file, bool print,
                  CRFConfig& config);

/** \brief Returns the given options. */
std::set<std::string> givenOptions(const po::variables_map& values);

/** \brief Refuses given options without effect. */
void refuseUnread(const po::variables_map& values,
                  const std::vector<UnreadOptions>& rules);

/** \brief Throws InvalidParameterException with a hint at the help. */
[[noreturn]] void failUsage(const std::string& message);

/** \brief Runs a check of the command line. Converts its InvalidParameterException by
 * failUsage(). */
template <typename Check>
void
asUsage(Check&& check)
{
  std::string message;
  try {
    return check();
  }
  catch (const InvalidParameterException& error) {
    message = error.what();
  }
  failUsage(message);
}

/** \brief Calls failUsage() if a condition holds. */
void refuseIf(bool condition, const std::string& message);

/** \brief Splits "a,b,c" at the commas. */
std::vector<std::string> splitAtCommas(const std::string& text);

/** \brief Parses the numbers of an option, separated by commas or spaces. Calls
 * failUsage() at an unreadable number. */
std::vector<double> parseNumbersOf(const std::string& option, std::string text);

/** \brief Refuses options of earlier versions, with a hint at their replacement.
 * \throws InvalidParameterException */
void refuseRemoved(int argc, char** argv,
                   const std::vector<std::pair<std::string, std::string>>& options);

} // namespace pcl_semantic::tool
