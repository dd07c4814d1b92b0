// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.h"
#include "core/fail.h"

#include <pcl_semantic/core/label_set.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

/** \brief Functions shared by the pcl_semantic_* programs. */
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

/** \brief Runs the body of a tool. If it throws, prints the exception as one line on
 * standard error.
 * \return exit code of the body or of the exception */
int run(const std::string& name, const std::function<int()>& body);

/** \brief Runs steps 0, 1, ... of a tool with a progress bar.
 * \param[in] what, unit as for ProgressBar
 * \throws Exit after a step during which an interrupt arrived */
void forEachStep(const std::string& what, std::size_t steps,
                 const std::function<void(std::size_t)>& step,
                 const std::string& unit = "frames");

/** \brief Checks the path of an output file, before the work starts. An empty path is
 * ignored.
 * \param[in] extension ".png"
 * \throws InvalidParameterException if the path has another extension
 * \throws OutputException if its folder does not exist */
void requireOutput(const std::string& path, const std::string& extension);

/** \brief Warns if a folder contains other files with the extensions of the output.
 * Programs that read the folder would take all these files as one sequence.
 * \param[in] written paths of the output in that folder */
void warnOfOtherFiles(const std::string& folder,
                      const std::vector<std::string>& written);

/** \brief Whether two paths refer to one file; false for empty paths. */
bool areSameFile(const std::string& a, const std::string& b);

/** \brief Checks that no output is the same file as an input or another output. Empty
 * paths are ignored.
 * \throws InvalidParameterException that names the file */
void refuseSameFiles(const std::vector<std::string>& inputs,
                     const std::vector<std::string>& outputs);

/** \brief Returns the classes to evaluate.
 * \param[in] ignored numbers or names of the other classes, separated by commas, or
 * "none"; default: sky, pedestrian and cyclist, if they exist
 * \throws InvalidParameterException at an unknown class, or if none is left */
std::vector<Label> evaluatedClasses(const std::optional<std::string>& ignored,
                                    const LabelSet& label_set);

/** \brief Catches SIGINT, SIGTERM and SIGHUP (a closed terminal), see interrupted(). A
 * second signal ends the program at once. */
void catchInterrupts();

/** \brief Does the same as catchInterrupts() for a program with an unsaved map. The
 * first signal prints that the map is being finished. The second is ignored, because a
 * key may repeat. The third ends the program at once. */
void catchInterruptsOfMap();

/** \brief Whether an interrupt arrived since catchInterrupts(). */
bool interrupted();

/** \brief Keeps freed memory in the program, in huge pages if available. Every frame
 * needs the same amount of memory again. Returning it to the system would cost a third
 * of the time per frame. */
void keepFreedMemory();

/** \brief Restarts the program with a short spin time for OpenMP's threads, because
 * long spinning blocks the threads of a network. The restart is necessary because
 * libgomp reads the setting before main(). Does nothing if the environment sets a spin
 * time.
 * \param[in] argv of main() */
void restartWithShortSpins(char** argv);

} // namespace pcl_semantic::tool
