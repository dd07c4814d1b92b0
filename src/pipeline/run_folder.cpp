// SPDX-License-Identifier: BSD-3-Clause
#include "run_folder.h"

#include "core/fail.h"
#include "extra_output.h"
#include "files/report_text.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/version.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Null if there is none of ours.
nlohmann::json
summaryAt(const std::string& path)
{
  if (!fs::exists(path))
    return {};
  const std::vector<std::uint8_t> bytes = readBytes(path);
  nlohmann::json summary =
      nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
  const bool is_ours = summary.is_object() && summary.contains("versions") &&
                       summary["versions"].contains("pcl_semantic");
  return is_ours ? summary : nlohmann::json();
}

bool
isFinished(const std::string& folder)
{
  const nlohmann::json summary = summaryAt(folder + "/summary.json");
  return summary.is_object() && summary.value("finished", false);
}

// What a run has left, but for files of the kept frames.
void
removeFrames(const std::string& folder, const std::vector<int>& kept)
{
  const auto isGone = [&](int frame) {
    return !std::binary_search(kept.begin(), kept.end(), frame);
  };
  std::error_code error;
  for (const char* const name : RunFolder::frame_folders)
    if (fs::is_directory(folder + "/" + name, error))
      removeFrameFiles(folder + "/" + name, ".png", isGone);
  if (fs::is_directory(folder + "/final_labels", error))
    removeFrameFiles(folder + "/final_labels", ".png");
  ExtraOutput::removeEarlier(folder, kept);
}

// Folders that hold something else stay.
void
removeEmpty(const std::string& folder, const std::vector<std::string>& names)
{
  std::error_code error;
  for (const std::string& name : names)
    fs::remove(folder + "/" + name, error);
}

std::vector<std::string>
imageFolders()
{
  std::vector<std::string> names(std::begin(RunFolder::frame_folders),
                                 std::end(RunFolder::frame_folders));
  names.push_back("final_labels");
  return names;
}

// A whole map folder and itself, unless it holds something else.
void
removeMap(const std::string& folder)
{
  removeFrames(folder, {});
  removeEmpty(folder, RunFolder::names());
  std::error_code error;
  fs::remove(folder, error);
}

void
moveIfThere(const std::string& from, const std::string& to)
{
  std::error_code error;
  if (!fs::exists(from, error))
    return;
  fs::rename(from, to, error);
  if (error)
    fail<OutputException>(from, ": cannot be moved to ", to, ": ", error.message());
}

// File by file, the summary last: killed, it goes on where it was, and what others have
// put there stays.
void
setAside(const std::string& folder)
{
  const std::string previous = folder + "/" + RunFolder::previous;
  if (fs::exists(previous + "/summary.json"))
    removeMap(previous);
  makeOutputFolder(previous);
  for (const std::string& name : RunFolder::names()) {
    std::error_code error;
    const std::string from = folder + "/" + name, to = previous + "/" + name;
    if (!fs::is_directory(from, error)) {
      moveIfThere(from, to);
      continue;
    }
    if (name == RunFolder::previous || name == RunFolder::live)
      continue;
    makeOutputFolder(to);
    for (const FrameFile& file : listFrameFiles(from, {".png", ".label", ".npy"}))
      moveIfThere(file.path, to + "/" + fs::path(file.path).filename().string());
  }
}

} // namespace

const std::vector<std::string>&
RunFolder::names()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = imageFolders();
    all.insert(all.end(), ExtraOutput::names().begin(), ExtraOutput::names().end());
    all.insert(all.end(), std::begin(map_files), std::end(map_files));
    all.insert(all.end(), {live, previous, "summary.json"}); // what says so comes last
    return all;
  }();
  return names;
}

bool
RunFolder::isSummary(const std::string& path)
{
  return summaryAt(path).is_object();
}

void
RunFolder::beginRun(const std::string& folder, const std::vector<int>& kept,
                    bool has_images)
{
  if (kept.empty() && isFinished(folder))
    setAside(folder);
  removeFrames(folder, kept);
  if (!has_images)
    removeEmpty(folder, imageFolders());
  removeEmpty(folder, {std::begin(map_files), std::end(map_files)});
  removeMap(folder + "/" + live);
  const nlohmann::ordered_json unfinished{
      {"finished", false}, {"versions", {{"pcl_semantic", PCL_SEMANTIC_VERSION}}}};
  writeTextFile(folder + "/summary.json", jsonText(unfinished));
  if (has_images)
    for (const std::string& name : imageFolders())
      makeOutputFolder(folder + "/" + name);
}

void
RunFolder::endRun(const std::string& folder)
{
  removeMap(folder + "/" + live);
  removeMap(folder + "/" + previous);
}

} // namespace pcl_semantic
