// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pcl_semantic::tool {

/** \brief How a tool talks: --quiet, --verbose, --json. */
struct Manner {
  std::string name = "pcl_semantic"; ///< of the tool, before each message
  bool quiet = false;
  bool verbose = false;
  bool json = false;
};

/** \brief That of this program; the command line sets it. */
Manner& manner();

/** \brief Results of a program, by name. */
using Results =
    std::vector<std::pair<std::string, std::variant<std::string, double, std::size_t>>>;

/** \brief Prints results on standard output: a line "name: value" each (values of
 * several lines below their name), or one JSON object with --json. */
void printFigures(const Results& results);

/** \brief Likewise what is a table as text.
 * \param[in] json an object, with its last line break */
void printFigures(const std::string& text, const std::string& json);

/** \brief As printFigures() what is no more than a word that all went well: with
 * --quiet alone nothing. */
void printResults(const Results& results);

/** \brief Warns on standard error: "NAME: warning: MESSAGE", in a line of its own even
 * while a progress bar is there. */
void warn(const std::string& message);

/** \brief Warns of each doubt that the library gives, a line each, once. */
void warnOf(const std::vector<std::string>& doubts);

/** \brief With --verbose: "NAME: 12.3 s: MESSAGE", the time since the program began, on
 * standard error. */
void note(const std::string& message);

/** \brief A progress bar on standard error: only on a terminal, not with --quiet, and
 * only for work that takes longer than a second. With --verbose a note a step. */
class ProgressBar {
public:
  /** \param[in] what "mapping"
   * \param[in] total number of steps
   * \param[in] unit of a step */
  ProgressBar(std::string what, std::size_t total, std::string unit = "frames");
  ~ProgressBar();

  /** \brief One step is done; draws ten times a second. */
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

/** \brief A line about work without a known end, on standard error: on a terminal in
 * place, at most four times a second; with --verbose a note each time. */
class StatusLine {
public:
  explicit StatusLine(std::string what);
  ~StatusLine();

  void show(const std::string& text);

  /** \brief Leaves the last text. */
  void end();

private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  Clock::time_point next_{};
  bool terminal_;
};

} // namespace pcl_semantic::tool
