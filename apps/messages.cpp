// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <iostream>

namespace pcl_semantic::tool {

namespace {

const auto begin = std::chrono::steady_clock::now();

bool bar_is_drawn = false; // there is one at a time

void
printLine(const std::string& line)
{
  if (bar_is_drawn)
    std::fputs("\r\033[K", stderr); // the bar comes back with its next step
  std::fprintf(stderr, "%s\n", line.c_str());
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
    std::visit([&, &name = name](const auto& known) { object[name] = known; }, value);
  if (manner().json) {
    std::cout << object.dump(2) << "\n";
    return;
  }
  for (const auto& [name, value] : object.items()) {
    const std::string text =
        value.is_string() ? value.get<std::string>() : value.dump();
    const bool has_lines = text.find('\n') != std::string::npos;
    std::cout << name << (has_lines ? ":\n" : ": ") << text << "\n";
  }
}

void
printFigures(const std::string& text, const std::string& json)
{
  std::cout << (manner().json ? json : text);
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
note(const std::string& message)
{
  if (!manner().verbose)
    return;
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin;
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.1f s", since.count());
  printLine(manner().name + ": " + seconds + ": " + message);
}

void
setBarIsDrawn(bool is_drawn)
{
  bar_is_drawn = is_drawn;
}

bool
barIsDrawn()
{
  return bar_is_drawn;
}

} // namespace pcl_semantic::tool
