// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"
#include "files/report_text.h"

#include <pcl_semantic/core/printable.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <set>

#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

const auto begin = std::chrono::steady_clock::now();

bool bar_is_drawn = false; // at most one

void
printLine(const std::string& line)
{
  if (bar_is_drawn)
    std::fputs("\r\033[K", stderr); // the next step redraws the bar
  std::fprintf(stderr, "%s\n", printable(line).c_str());
}

} // namespace

Manner&
manner()
{
  static Manner manner;
  return manner;
}

void
printFigures(const Results& results)
{
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const auto& [name, value] : results)
    std::visit([&, &key = name](const auto& known) { object[key] = known; }, value);
  if (manner().json) {
    std::cout << jsonText(object);
    return;
  }
  for (const auto& [name, value] : object.items()) {
    const std::string text =
        value.is_string() ? printable(value.get<std::string>(), true) : value.dump();
    const bool has_lines = text.find('\n') != std::string::npos;
    std::cout << name << (has_lines ? ":\n" : ": ") << text << "\n";
  }
}

void
printFigures(const std::string& text, const std::string& json)
{
  std::cout << (manner().json ? json : printable(text, true));
}

void
printResults(const Results& results)
{
  if (manner().json || !manner().quiet)
    printFigures(results);
}

void
warn(const std::string& message)
{
  printLine(manner().name + ": warning: " + message);
}

void
warnOf(const std::vector<std::string>& doubts)
{
  static std::set<std::string> told; // runs of submaps open the same files again
  for (const std::string& doubt : doubts)
    if (told.insert(doubt).second)
      warn(doubt);
}

void
note(const std::string& message)
{
  if (!manner().verbose)
    return;
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin;
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.1f s", since.count());
  printLine(manner().name + ": " + seconds + ": " + message);
}

ProgressBar::ProgressBar(std::string what, std::size_t total, std::string unit)
    : what_(std::move(what)), total_(total), unit_(std::move(unit)),
      terminal_(isatty(STDERR_FILENO) == 1 && !manner().quiet && !manner().verbose)
{}

ProgressBar::~ProgressBar()
{
  if (bar_is_drawn)
    std::fprintf(stderr, "\n");
  bar_is_drawn = false;
}

void
ProgressBar::step()
{
  ++done_;
  note(what_ + " " + std::to_string(done_) + " of " + std::to_string(total_));
  const Clock::time_point now = Clock::now();
  const bool is_last = done_ == total_;
  if (!terminal_ || now < (is_last ? start_ + std::chrono::seconds(1) : next_))
    return;
  next_ = now + std::chrono::milliseconds(100);
  const double seconds = std::chrono::duration<double>(now - start_).count();
  constexpr int width = 30;
  const int filled = static_cast<int>(width * done_ / total_);
  const double rate = double(done_) / seconds;
  std::fprintf(stderr, "\r%s [%s%s] %zu/%zu  %.1f %s/s  %.0f s left ", what_.c_str(),
               std::string(filled, '#').c_str(),
               std::string(width - filled, '.').c_str(), done_, total_, rate,
               unit_.c_str(), double(total_ - done_) / rate);
  std::fflush(stderr);
  bar_is_drawn = true;
}

StatusLine::StatusLine(std::string what)
    : what_(std::move(what)),
      terminal_(isatty(STDERR_FILENO) == 1 && !manner().quiet && !manner().verbose)
{}

StatusLine::~StatusLine()
{
  end();
}

void
StatusLine::show(const std::string& text)
{
  note(what_ + ": " + text);
  const Clock::time_point now = Clock::now();
  if (!terminal_ || now < next_)
    return;
  next_ = now + std::chrono::milliseconds(250);
  std::fprintf(stderr, "\r%s: %s\033[K", what_.c_str(), printable(text).c_str());
  std::fflush(stderr);
  bar_is_drawn = true;
}

void
StatusLine::end()
{
  if (terminal_ && bar_is_drawn)
    std::fprintf(stderr, "\n");
  bar_is_drawn = false;
}

} // namespace pcl_semantic::tool
