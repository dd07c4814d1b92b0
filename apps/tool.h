// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/program_options.hpp>

#include <functional>
#include <sstream>
#include <string>
#include <vector>

/** \brief What all pcl_semantic_* programs share: options and exit codes. */
namespace pcl_semantic::tool {

namespace po = boost::program_options;

/** \brief Exit codes of every tool. */
enum ExitCode {
  exit_done = 0,
  exit_usage = 2,
  exit_bad_input = 3,
  exit_bad_model = 4,
  exit_output_failed = 5,
  exit_out_of_memory = 6,
  exit_interrupted = 130
};

/** \brief The parts of a tool's `--help`. */
struct Usage {
  std::string name;        ///< "pcl_semantic_map"
  std::string synopsis;    ///< "SEQUENCE --output DIR [options]"
  std::string description; ///< what it does, one or two sentences
  std::string example;     ///< a command that works when pasted
};

/** \brief Parses the command line; adds `--help`, `--version`, and `--quiet`,
 * `--verbose` and `--json`, which set manner(). \return false if the help or the
 * version was printed and nothing is left to do \throws InvalidParameterException at
 * unknown options, missing or unreadable values */
bool parseCommandLine(int argc, char** argv, const Usage& usage,
                      const po::options_description& options,
                      const po::positional_options_description& positional,
                      po::variables_map& values);

/** \brief Of --label-mapping, the numbers in a file to the classes of the label set. */
constexpr const char* label_mapping_help =
    "numbers of the input to classes of the label set: a file (YAML), the name of one "
    "that is installed (semantic_kitti_to_kitti11), or zero_based (default: they are "
    "labels, 0 = unlabelled)";

/** \brief The same where the input may be images. */
constexpr const char* pixel_mapping_help =
    "numbers of the input to classes of the label set: a file (YAML), the name of one "
    "that is installed (semantic_kitti_to_kitti11), zero_based, or of .png colours, "
    "those of the classes (default: they are labels, 0 = unlabelled)";

/** \brief A value as help shows it: 0.7, not 0.69999999999999996. */
template <typename T>
std::string
shown(const T& value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

/** \brief Adds an option whose value is its default. */
template <typename T>
void
addOption(po::options_description& options, const char* name, T& value,
          const char* text)
{
  options.add_options()(name, po::value<T>(&value)->default_value(value, shown(value)),
                        text);
}

/** \brief Throws InvalidParameterException, with a word on where help is. */
[[noreturn]] void failUsage(const Usage& usage, const std::string& message);

/** \brief Runs the body of a tool and turns what it throws into one line on standard
 * error and the exit code that belongs to it. */
int run(const std::string& name, const std::function<int()>& body);

/** \brief Refuses a file to write before the work for it begins: by a name that
 * promises another kind of file, or because its folder is not there; an empty path is
 * none.
 * \param[in] extension ".png"
 * \throws InvalidParameterException, OutputException */
void requireOutput(const std::string& path, const std::string& extension);

/** \brief Warns if a folder holds files of the kind that will be written beside those
 * that will be: what reads the folder takes them for one sequence. \param[in] written
 * paths in that folder */
void warnOfOtherFiles(const std::string& folder,
                      const std::vector<std::string>& written);

/** \brief Refuses outputs that are also inputs, or each other; empty paths are no
 * files. \throws InvalidParameterException */
void refuseSameFiles(const std::vector<std::string>& inputs,
                     const std::vector<std::string>& outputs);

/** \brief From now on SIGINT, SIGTERM and SIGHUP (a terminal that is gone) only set a
 * flag; a second one ends at once. */
void catchInterrupts();

/** \brief Whether one came since catchInterrupts(). */
bool interrupted();

} // namespace pcl_semantic::tool
