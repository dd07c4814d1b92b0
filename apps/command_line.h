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

/** \brief The parts of a tool's `--help`. */
struct Usage {
  std::string name;        ///< "pcl_semantic_map"
  std::string synopsis;    ///< "SEQUENCE --output DIR [options]"
  std::string description; ///< what it does, one or two sentences
  std::string example;     ///< a command that works when pasted
  /// What `--help` lists, where all options would not fit on a screen: an option with
  /// its value ("labels DIR"), and its help in a line; `--help-all` lists the rest.
  std::vector<std::pair<std::string, std::string>> often{};
};

/** \brief An option of a tool: its name ("output,o"), where its value goes, its help.
 */
struct Option {
  /** \brief Any value, or several of a std::vector; without a default to show. */
  template <typename T>
  Option(const std::string& name, T& value, std::string help)
      : Option(name, po::value(&value), std::move(help))
  {}

  /** \brief A switch. */
  Option(const std::string& name, bool& value, std::string help)
      : Option(name, po::bool_switch(&value), std::move(help))
  {}

  /** \brief Another kind: required(...), withDefault(...). */
  Option(std::string name, const po::value_semantic* value, std::string help)
      : names(std::move(name)), target(value), text(std::move(help))
  {}

  std::string names;
  const po::value_semantic* target;
  std::string text;
};

/** \brief The value of an option that has to be given. */
template <typename T>
po::typed_value<T>*
required(T& value)
{
  return po::value(&value)->required();
}

/** \brief A value as help shows it: 0.7, not 0.69999999999999996. */
template <typename T>
std::string
shown(const T& value)
{
  TextStream text;
  text << value;
  return text.str();
}

/** \brief The value of an option, which is its default and shown as such. */
template <typename T>
po::typed_value<T>*
withDefault(T& value)
{
  return po::value<T>(&value)->default_value(value, shown(value));
}

/** \brief Options of inputs: a `bool` is a switch, and a default is shown. */
std::vector<Option> optionsOf(const ConfigParameters& parameters);

/** \brief Parses the command line; adds `--help`, `--help-all`, `--version` and
 * `--man`, which end the tool, and `--quiet`, `--verbose` and `--json`, which set
 * manner(). \param[in] options in the order of the help \param[in] positional options
 * that need no name; a last one "files..." takes all that is left \param[in] parameters
 * each an option, too, see setParameters() \throws Exit if help was printed \throws
 * InvalidParameterException at unknown options, missing or unreadable values */
po::variables_map parseCommandLine(int argc, char** argv, const Usage& usage,
                                   const std::vector<Option>& options,
                                   const std::vector<std::string>& positional = {},
                                   const ConfigParameters& parameters = {});

/** \brief Sets the parameters whose options were given.
 * \throws InvalidParameterException if a value cannot be read */
void setParameters(const po::variables_map& values, ConfigParameters parameters);

/** \brief Sets a CRF as its tools are told to: by \a file (YAML; empty = none), then by
 * the options that were given.
 * \param[in] print the result, as YAML, and end the tool
 * \throws Exit if it was printed
 * \throws InvalidParameterException, BadInputException */
void setCRFConfig(const po::variables_map& values, const std::string& file, bool print,
                  CRFConfig& config);

/** \brief The options that were given. */
std::set<std::string> givenOptions(const po::variables_map& values);

/** \brief Refuses options that were given and would have no effect. */
void refuseUnread(const po::variables_map& values,
                  const std::vector<UnreadOptions>& rules);

/** \brief Throws InvalidParameterException, with a word on where help is. */
[[noreturn]] void failUsage(const std::string& message);

/** \brief Runs a check of the command line: an InvalidParameterException of it ends in
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

/** \brief failUsage() if a condition holds. */
void refuseIf(bool condition, const std::string& message);

/** \brief "a,b,c" without the commas. */
std::vector<std::string> splitAtCommas(const std::string& text);

/** \brief The numbers of an option, with commas or spaces between them; those that
 * cannot be read end in failUsage(). */
std::vector<double> parseNumbersOf(const std::string& option, std::string text);

/** \brief Refuses options of earlier versions, each with a word on what there is in its
 * place. \throws InvalidParameterException */
void refuseRemoved(int argc, char** argv,
                   const std::vector<std::pair<std::string, std::string>>& options);

} // namespace pcl_semantic::tool
