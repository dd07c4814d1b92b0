// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.h"
#include "core/fail.h"

#include <pcl_semantic/core/label_set.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

/** \brief Options and exit codes of all pcl_semantic_* programs. */
namespace pcl_semantic::tool {

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

/** \brief Thrown to end a tool early, without a message. */
struct Exit {
  ExitCode code;
};

/** \brief Runs the body of a tool. Converts an exception to one line on standard error
 * and its exit code. */
int run(const std::string& name, const std::function<int()>& body);

/** \brief Runs the steps of a tool, with a progress bar, until an interrupt.
 * \param[in] what, unit as for ProgressBar
 * \throws Exit after the interrupted step */
void forEachStep(const std::string& what, std::size_t steps,
                 const std::function<void(std::size_t)>& step,
                 const std::string& unit = "frames");

/** \brief Refuses an output file before the work starts: if its extension is of another
 * format, or its folder does not exist. An empty path is ignored.
 * \param[in] extension ".png"
 * \throws InvalidParameterException, OutputException */
void requireOutput(const std::string& path, const std::string& extension);

/** \brief Warns if a folder contains other files of the output's kind: readers would
 * take all of them for one sequence.
 * \param[in] written paths in that folder */
void warnOfOtherFiles(const std::string& folder,
                      const std::vector<std::string>& written);

/** \brief Whether two paths refer to one file; false for empty paths. */
bool areSameFile(const std::string& a, const std::string& b);

/** \brief Refuses an output that is also an input or another output; empty paths are
 * ignored.
 * \throws InvalidParameterException */
void refuseSameFiles(const std::vector<std::string>& inputs,
                     const std::vector<std::string>& outputs);

/** \brief Returns the classes to evaluate.
 * \param[in] ignored numbers or names of the other classes, separated by commas, or
 * "none"; default: sky, pedestrian and cyclist, if they exist
 * \throws InvalidParameterException at an unknown class, or if none is left */
std::vector<Label> evaluatedClasses(const std::optional<std::string>& ignored,
                                    const LabelSet& label_set);

/** \brief Makes SIGINT, SIGTERM and SIGHUP (a closed terminal) set a flag. A second
 * signal ends the program at once. */
void catchInterrupts();

/** \brief catchInterrupts() for a program with an unsaved map. The first signal prints
 * that the map is being finished, the second is ignored (keys may repeat), and the
 * third ends the program at once. */
void catchInterruptsOfMap();

/** \brief Whether an interrupt arrived since catchInterrupts(). */
bool interrupted();

/** \brief Keeps freed memory in the program, in huge pages if available. Every frame
 * needs the same amount again, and new pages would cost a third of its time. */
void keepFreedMemory();

/** \brief Restarts the program with a short spinning time of OpenMP's threads, unless
 * its environment sets one: spinning threads would block the threads of a network.
 * libgomp reads the setting before main().
 * \param[in] argv of main() */
void restartWithShortSpins(char** argv);

} // namespace pcl_semantic::tool
