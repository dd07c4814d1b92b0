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

/** \brief Thrown to end a tool before its end, with nothing to say. */
struct Exit {
  ExitCode code;
};

/** \brief Runs the body of a tool and turns what it throws into one line on standard
 * error and the exit code that belongs to it. */
int run(const std::string& name, const std::function<int()>& body);

/** \brief Runs the steps of a tool's work, with a progress bar, until one interrupts.
 * \param[in] what, unit as ProgressBar takes them
 * \throws Exit after the step that was interrupted */
void forEachStep(const std::string& what, std::size_t steps,
                 const std::function<void(std::size_t)>& step,
                 const std::string& unit = "frames");

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

/** \brief Whether two paths mean one file; empty ones are none. */
bool areSameFile(const std::string& a, const std::string& b);

/** \brief Refuses outputs that are also inputs, or each other; empty paths are no
 * files. \throws InvalidParameterException */
void refuseSameFiles(const std::vector<std::string>& inputs,
                     const std::vector<std::string>& outputs);

/** \brief The classes whose ground truth counts.
 * \param[in] ignored numbers or names of the others with commas between them, or
 * "none"; not given: sky, pedestrian and cyclist, as far as there are such classes
 * \throws InvalidParameterException at a word that is no class, or if none is left */
std::vector<Label> evaluatedClasses(const std::optional<std::string>& ignored,
                                    const LabelSet& label_set);

/** \brief From now on SIGINT, SIGTERM and SIGHUP (a terminal that is gone) only set a
 * flag; a second one ends at once. */
void catchInterrupts();

/** \brief The same for a program with a map in memory that would be lost: the first
 * says that the map is being finished, a second (of two pressed in a row) is ignored,
 * and a third ends at once. */
void catchInterruptsOfMap();

/** \brief Whether one came since catchInterrupts(). */
bool interrupted();

/** \brief From now on memory that is freed stays with the program, in huge pages where
 * the system has them: what works frame by frame needs as much again, and new pages
 * cost a third of its time. */
void keepFreedMemory();

/** \brief Starts the program anew with OpenMP's threads set to sleep soon after their
 * work, unless its environment says how they wait: beside a network, a thread that
 * spins keeps another from running. libgomp reads this before main().
 * \param[in] argv of main() */
void restartWithShortSpins(char** argv);

} // namespace pcl_semantic::tool
