// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"
#include "core/split.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/config_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/version.h>

#include <algorithm>
#include <iostream>

namespace pcl_semantic::tool {

namespace {

// Escapes text for man(7); hyphens are those of options, so that they can be copied.
std::string
escaped(const std::string& text)
{
  std::string result;
  bool begins_line = true;
  for (const char letter : text) {
    if (begins_line && (letter == '.' || letter == '\''))
      result += "\\&";
    if (letter == '\\')
      result += "\\e";
    else if (letter == '-')
      result += "\\-";
    else
      result += letter;
    begins_line = letter == '\n';
  }
  return result;
}

// "does this" of "Does this. And that.", on one line.
std::string
firstSentence(const std::string& description)
{
  std::string sentence = description.substr(0, description.find(". "));
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  if (!sentence.empty() && sentence.back() == '.')
    sentence.pop_back();
  return sentence;
}

// Boost writes "-o [ --output ]".
std::string
optionLine(const po::option_description& option)
{
  std::string line;
  const std::string name = option.format_name();
  if (name.size() > 1 && name[1] != '-')
    line = name.substr(0, 2) + ", ";
  line = "\\fB" + escaped(line + "--" + option.long_name()) + "\\fR";
  const std::string value = option.format_parameter();
  return value.empty() ? line : line + " " + escaped(value);
}

// The help as a manual page, in the macros of man(7).
std::string
manualPage(const Usage& usage, const po::options_description& options)
{
  std::string page = ".TH " + usage.name + " 1 \"\" \"pcl_semantic " +
                     PCL_SEMANTIC_VERSION + "\" \"User Commands\"\n";
  page += ".SH NAME\n" + usage.name + " \\- " +
          escaped(firstSentence(usage.description)) + "\n";
  page += ".SH SYNOPSIS\n.B " + usage.name + "\n" + escaped(usage.synopsis) + "\n";
  page += ".SH DESCRIPTION\n" + escaped(usage.description) + "\n";
  page += ".SH OPTIONS\n";
  for (const auto& option : options.options())
    page +=
        ".TP\n" + optionLine(*option) + "\n" + escaped(option->description()) + "\n";
  page += ".SH EXAMPLE\n.nf\n" + escaped(usage.example) + "\n.fi\n";
  page += ".SH EXIT STATUS\n0: success; 2: wrong command line; 3: wrong input; 4: "
          "wrong network; 5: an output could not be written; 6: out of memory; 130: "
          "interrupted.\n";
  return page;
}

// Explains an unknown option, which may be from an earlier version.
std::string
refusalOf(const po::unknown_option& error, const ConfigParameters& parameters)
{
  std::string option = error.get_option_name();
  option = option.substr(0, option.find('='));
  std::string name = option;
  name.erase(0, name.find_first_not_of('-'));
  std::replace(name.begin(), name.end(), '-', '_');
  std::string why = whyRemoved(name);
  for (const ConfigParameter& parameter : parameters)
    if (parameter.name == name)
      why = "is no option, only a key of --config files";
  return why.empty() ? error.what() : option + ": " + why;
}

// The most used options; a test ensures that they fit on a screen.
void
printHelp(const Usage& usage, const po::options_description& all, bool is_whole)
{
  std::cout << "Usage: " << usage.name << " " << usage.synopsis << "\n\n"
            << usage.description << "\n\nExample:\n  " << usage.example << "\n";
  if (is_whole || usage.often.empty()) {
    std::cout << all;
    return;
  }
  constexpr std::size_t column = 28;
  std::cout << "\nOptions that are used most:\n";
  for (const auto& [option, help] : usage.often)
    std::cout << "  --" << option
              << std::string(column - std::min(column - 1, option.size() + 4), ' ')
              << help << "\n";
  std::cout
      << "\n--help-all lists all options. Each program also has --help, --version, "
         "--quiet,\n--verbose, --json and --man.\n";
}

// Parses the options of a tool and the common ones; ends the tool after help.
po::variables_map
parseOptions(int argc, char** argv, const Usage& usage,
             const po::options_description& options,
             const po::positional_options_description& positional,
             const ConfigParameters& parameters)
{
  po::options_description general("General");
  Manner& how = manner();
  how.name = usage.name;
  general.add_options()("help,h", "print help")("help-all", "print all options")(
      "version", "print the version")("quiet,q", po::bool_switch(&how.quiet),
                                      "print only errors, warnings and results")(
      "verbose,v", po::bool_switch(&how.verbose),
      "print each step with the time since the start")(
      "json", po::bool_switch(&how.json),
      "print results as JSON")("man", "print this help as a manual page");
  po::options_description all;
  all.add(options).add(general);
  po::variables_map values;
  try {
    // No abbreviations: they would change their meaning with new options.
    using namespace po::command_line_style;
    po::store(po::command_line_parser(argc, argv)
                  .options(all)
                  .positional(positional)
                  .style(unix_style & ~allow_guessing)
                  .run(),
              values);
    if (values.count("help") || values.count("help-all")) {
      printHelp(usage, all, values.count("help-all") > 0);
      throw Exit{exit_done};
    }
    if (values.count("man")) {
      std::cout << manualPage(usage, all);
      throw Exit{exit_done};
    }
    if (values.count("version")) {
      std::cout << usage.name << " " << PCL_SEMANTIC_VERSION << "\n";
      throw Exit{exit_done};
    }
    po::notify(values);
    refuseIf(how.quiet && how.verbose, "--quiet and --verbose exclude each other");
  }
  catch (const po::too_many_positional_options_error&) {
    failUsage("too many positional arguments; a pattern of file names has to be in "
              "quotes: --left 'left/*.png'");
  }
  catch (const po::unknown_option& error) {
    failUsage(refusalOf(error, parameters));
  }
  catch (const po::error& error) {
    failUsage(error.what());
  }
  return values;
}

} // namespace

po::variables_map
parseCommandLine(int argc, char** argv, const Usage& usage,
                 const std::vector<Option>& options,
                 const std::vector<std::string>& positional,
                 const ConfigParameters& parameters)
{
  po::options_description description("Options");
  for (const Option& option : options)
    description.add_options()(option.names.c_str(), option.target, option.text.c_str());
  po::options_description group("Parameters (with their defaults)");
  for (const ConfigParameter& parameter : parameters)
    if (parameter.preset_default.empty())
      group.add_options()(parameter.option().c_str(),
                          po::value<std::string>()->value_name(parameter.text()),
                          parameter.help.c_str());
  if (!parameters.empty())
    description.add(group);
  po::positional_options_description order;
  for (const std::string& name : positional) {
    const std::size_t dots = name.find("...");
    order.add(name.substr(0, dots).c_str(), dots == std::string::npos ? 1 : -1);
  }
  return parseOptions(argc, argv, usage, description, order, parameters);
}

std::vector<Option>
optionsOf(const ConfigParameters& parameters)
{
  std::vector<Option> options;
  for (const ConfigParameter& parameter : parameters) {
    const std::string name = parameter.option();
    if (auto* const value = std::get_if<bool*>(&parameter.value))
      options.emplace_back(name, **value, parameter.help);
    else if (auto* const text = std::get_if<std::string*>(&parameter.value);
             text && (*text)->empty())
      options.emplace_back(name, **text, parameter.help);
    else if (text)
      options.emplace_back(name, withDefault(**text), parameter.help);
    else if (auto* const number = std::get_if<double*>(&parameter.value))
      options.emplace_back(name, withDefault(**number), parameter.help);
    else
      badParameter("parameter ", parameter.name,
                   " has a type that is not supported for inputs");
  }
  return options;
}

std::set<std::string>
givenOptions(const po::variables_map& values)
{
  std::set<std::string> given;
  for (const auto& [name, value] : values)
    if (!value.defaulted())
      given.insert(name);
  return given;
}

void
refuseUnread(const po::variables_map& values, const std::vector<UnreadOptions>& rules)
{
  asUsage([&] { pcl_semantic::refuseUnread(givenOptions(values), rules); });
}

void
setParameters(const po::variables_map& values, ConfigParameters parameters)
{
  for (ConfigParameter& parameter : parameters)
    if (parameter.preset_default.empty() && values.count(parameter.option()))
      try {
        parameter.set(values[parameter.option()].as<std::string>(),
                      "--" + parameter.option());
      }
      catch (const BadInputException& error) {
        throw InvalidParameterException(error.what());
      }
}

void
setCRFConfig(const po::variables_map& values, const std::string& file, bool print,
             CRFConfig& config)
{
  readConfig(file, config);
  setParameters(values, parametersOf(config));
  config.validate();
  if (!print)
    return refuseUnread(values, unreadOptionsOfCRF(parametersOf(config).front().text(),
                                                   config.cliques));
  std::cout << printParameters(parametersOf(config));
  throw Exit{exit_done};
}

void
failUsage(const std::string& message)
{
  badParameter(message, " (see ", manner().name, " --help)");
}

void
refuseIf(bool condition, const std::string& message)
{
  if (condition)
    failUsage(message);
}

std::vector<std::string>
splitAtCommas(const std::string& text)
{
  std::vector<std::string> words;
  for (const std::string_view word : splitAt(',', text))
    words.emplace_back(word);
  return words;
}

std::vector<double>
parseNumbersOf(const std::string& option, std::string text)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  try {
    return parseNumbers(text, option);
  }
  catch (const BadInputException& error) {
    failUsage(error.what());
  }
}

void
refuseRemoved(int argc, char** argv,
              const std::vector<std::pair<std::string, std::string>>& options)
{
  for (int i = 1; i < argc; ++i)
    for (const auto& [name, instead] : options) {
      const std::string word = argv[i];
      refuseIf(word.substr(0, word.find('=')) == "--" + name,
               "--" + name + " was removed: " + instead);
    }
}

} // namespace pcl_semantic::tool
