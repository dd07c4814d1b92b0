// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/process_limits.h"
#include "support/tiny_street.h"

#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A case in which a tool must fail. */
struct BadCase {
  /** \brief Damages a copy of the sequence. */
  using Damage = std::function<void(const std::string& street)>;

  int code;         ///< expected exit code
  std::string says; ///< part of the line expected on standard error
  /** \brief Options of `map STREET --output OUT` or, without a leading dash, a whole
   * command. STREET, OUT and TEMP are replaced by the sequence, the output and their
   * parent. */
  std::string command = "--labels STREET/labels";
  Damage damage = nullptr;
};

/** \brief Replaces every \a from in \a text by \a to. */
inline std::string
replaceAll(std::string text, const std::string& from, const std::string& to)
{
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;
       at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/** \brief EXPECTs that the output has no file of a complete map, that the summary
 * states so, and that every other file is a complete image. */
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

/** \brief Runs a case and EXPECTs its exit code, one line with the program's name and
 * the error, and no incomplete files in the output folder. */
inline void
expectFails(const BadCase& bad)
{
  SCOPED_TRACE(bad.says);
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
  // Wrong options are reported before any output.
  EXPECT_FALSE(bad.code == 2 && !output_was_there && std::filesystem::exists(output));
}

/** \brief EXPECTs that a run ends with one line about the file that the disk, with room
 * for so few bytes a file, had no room for. */
inline void
expectDiskFull(const std::string& command, rlim_t bytes, const std::string& path)
{
  const ToolResult result = [&] {
    const FullDisk disk(bytes);
    return runTool(command, kStartedAnew);
  }();
  EXPECT_EQ(result.code, 5) << result.text;
  EXPECT_EQ(result.text, "pcl_semantic_" + command.substr(0, command.find(' ')) + ": " +
                             path +
                             ": could not be written completely (is the disk full?)\n");
}

inline void
expectAllFail(const std::vector<BadCase>& cases)
{
  for (const BadCase& bad : cases)
    expectFails(bad);
}

} // namespace pcl_semantic
