// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Verbosity of a tool: --quiet, --verbose, --json. */
struct Manner {
  std::string name = "pcl_semantic"; ///< of the tool, prefix of each message
  bool quiet = false;
  bool verbose = false;
  bool json = false;
};

/** \brief The manner of this program, set by the command line. */
Manner& manner();

/** \brief Results of a program, by name. */
using Results =
    std::vector<std::pair<std::string, std::variant<std::string, double, std::size_t>>>;

/** \brief Prints results on standard output: one line "name: value" each (values of
 * several lines below their name), or one JSON object with --json. */
void printFigures(const Results& results);

/** \brief Prints a table as text, or as JSON with --json.
 * \param[in] json an object, including its last line break */
void printFigures(const std::string& text, const std::string& json);

/** \brief Prints a success report like printFigures(); --quiet suppresses it, except
 * with --json. */
void printResults(const Results& results);

/** \brief Warns on standard error: "NAME: warning: MESSAGE", on a separate line even
 * during a progress bar. */
void warn(const std::string& message);

/** \brief Warns of each doubt of the library, one per line, without repetition. */
void warnOf(const std::vector<std::string>& doubts);

/** \brief With --verbose prints "NAME: 12.3 s: MESSAGE" on standard error, with the
 * time since the program's start. */
void note(const std::string& message);

/** \brief A progress bar on standard error: only on a terminal, without --quiet, and
 * for work longer than a second. With --verbose one note per step. */
class ProgressBar {
public:
  /** \param[in] what "mapping"
   * \param[in] total number of steps
   * \param[in] unit of a step */
  ProgressBar(std::string what, std::size_t total, std::string unit = "frames");
  ~ProgressBar();

  /** \brief Counts one step; draws at most ten times per second. */
  void step();

private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::size_t total_;
  std::string unit_;
  std::size_t done_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_ + std::chrono::seconds(1);
  bool terminal_;
};

/** \brief A status line for work without a known end, on standard error. A terminal
 * updates it in place, at most four times per second; with --verbose each update is a
 * note. */
class StatusLine {
public:
  explicit StatusLine(std::string what);
  ~StatusLine();

  void show(const std::string& text);

  /** \brief Keeps the last text on the screen. */
  void end();

private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  Clock::time_point next_{};
  bool terminal_;
};

} // namespace pcl_semantic::tool
