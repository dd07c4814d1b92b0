// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/tiny_street.h"

#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief One way to make a tool fail. */
struct BadCase {
  /** \brief Damages the copy of the street it is given. */
  using Damage = std::function<void(const std::string& street)>;

  std::string what;
  int code;         ///< expected exit code
  std::string says; ///< part of the line expected on standard error
  /** \brief Options of `map STREET --output OUT` or, without a dash in front, a whole
   * command. STREET, OUT and TEMP stand for the street, the output and their parent. */
  std::string command = "--labels STREET/labels";
  Damage damage = nullptr;
};

/** \brief \a text with \a to in place of every \a from. */
inline std::string
replaceAll(std::string text, const std::string& from, const std::string& to)
{
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;
       at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/** \brief EXPECTs that no file of the map as a whole is there, that the summary says
 * so, and that every other file is a finished image. */
inline void
expectNothingUnfinished(const std::string& output)
{
  if (!std::filesystem::is_directory(output))
    return;
  for (const char* name :
       {"map.pcd", "map_classes.pcd", "trajectory.txt", "top_view.png"})
    EXPECT_FALSE(std::filesystem::exists(output + "/" + name)) << name;
  for (const std::filesystem::directory_entry& entry :
       std::filesystem::recursive_directory_iterator(output)) {
    EXPECT_NE(entry.path().filename().string()[0], '.') << entry.path();
    if (entry.path().filename() == "summary.json") {
      EXPECT_NE(bytesOf(entry.path().string()).find("\"finished\": false"),
                std::string::npos);
    }
    else if (entry.is_regular_file()) {
      EXPECT_NO_THROW(readPng(entry.path().string(), ImageKind::grey_or_colour));
    }
  }
}

/** \brief Runs a case and EXPECTs its exit code, one line that names the program and
 * says what is wrong, and nothing unfinished in the output folder. */
inline void
expectFails(const BadCase& bad)
{
  SCOPED_TRACE(bad.what);
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), output = folder.path("out");
  copyStreet(street);
  if (bad.damage)
    bad.damage(street);
  std::string command = bad.command;
  if (command.empty() || command[0] == '-')
    command = "map STREET --output OUT " + command;
  command = replaceAll(command, "STREET", street);
  command = replaceAll(command, "OUT", output);
  command = replaceAll(command, "TEMP", folder.path());

  const bool output_was_there = std::filesystem::exists(output);
  expectFails(command, bad.code, bad.says);
  expectNothingUnfinished(output);
  // Wrong options are found before anything is written.
  EXPECT_FALSE(bad.code == 2 && !output_was_there && std::filesystem::exists(output));
}

/** \brief expectFails() of each. */
inline void
expectAllFail(const std::vector<BadCase>& cases)
{
  for (const BadCase& bad : cases)
    expectFails(bad);
}

} // namespace pcl_semantic
