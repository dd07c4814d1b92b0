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

// Null unless it is the summary of a run.
nlohmann::json
summaryAt(const std::string& path)
{
  std::error_code error; // a later write reports the error
  if (!fs::exists(path, error))
    return {};
  const std::vector<std::uint8_t> bytes = readBytes(path);
  nlohmann::json summary =
      nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
  const bool is_ours = summary.is_object() && summary.contains("versions") &&
                       summary["versions"].contains("pcl_semantic");
  return is_ours ? summary : nlohmann::json();
}

bool
isFinished(const nlohmann::json& summary)
{
  const auto finished = summary.find("finished");
  return summary.is_object() && finished != summary.end() && finished->is_boolean() &&
         finished->get<bool>();
}

// Marker file of a folder `previous` made by a run, which a run may remove. Links never
// count.
std::string
markOf(const std::string& previous)
{
  return previous + "/.set_aside";
}

bool
isOurs(const std::string& previous)
{
  std::error_code error;
  return fs::is_directory(fs::symlink_status(previous, error)) &&
         fs::exists(markOf(previous), error);
}

// Removes the output of a run, except files of the kept frames.
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

// Removes empty folders only.
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

void
removePrevious(const std::string& folder)
{
  const std::string previous = folder + "/" + RunFolder::previous;
  if (!isOurs(previous))
    return;
  removeFrames(previous, {});
  removeEmpty(previous, RunFolder::names());
  std::error_code error;
  fs::remove(markOf(previous), error);
  fs::remove(previous, error); // fails if the folder contains other files
}

void
removeLive(const std::string& folder)
{
  const std::string live = folder + "/" + RunFolder::live;
  removeEmpty(live, {"summary.json", "map.pcd", "label_set.yaml", "trajectory.txt"});
  std::error_code error;
  fs::remove(live, error);
}

void
moveIfThere(const std::string& from, const std::string& to)
{
  std::error_code error;
  if (!fs::exists(from, error))
    return;
  fs::rename(from, to, error);
  if (error == std::errc::cross_device_link) {
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
    if (!error)
      fs::remove(from, error);
  }
  if (error)
    fail<OutputException>(from, ": cannot be moved to ", to, ": ", error.message());
}

// Moves file by file, the summary last, so that a killed run can be resumed. Other
// files stay.
void
setAside(const std::string& folder)
{
  const std::string previous = folder + "/" + RunFolder::previous;
  std::error_code unknown;
  if (fs::exists(previous + "/summary.json", unknown))
    removePrevious(folder);
  makeOutputFolder(previous);
  writeTextFile(markOf(previous), "");
  const std::vector<std::string> images = imageFolders();
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
    const bool is_of_images = std::count(images.begin(), images.end(), name) > 0;
    for (const char* const extension : {".png", ".label", ".npy"})
      if (!is_of_images || extension == std::string(".png"))
        for (const FrameFile& file : listFrameFiles(from, {extension}))
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
    all.insert(all.end(), {live, previous, "summary.json"}); // last, see setAside()
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
RunFolder::requireRoom(const std::string& folder)
{
  const std::string path = folder + "/" + previous;
  std::error_code error;
  if (fs::exists(fs::symlink_status(path, error)) && !isOurs(path) &&
      isFinished(summaryAt(folder + "/summary.json")))
    fail<OutputException>(
        path, ": is not of an earlier run, but this run would move the earlier map "
              "there; choose another --output, or move this folder");
}

void
RunFolder::beginRun(const std::string& folder, const std::vector<int>& kept,
                    bool has_images)
{
  const nlohmann::json summary = summaryAt(folder + "/summary.json");
  if (isFinished(summary)) {
    if (summary.contains("frame_numbers") && summary["frame_numbers"] == kept)
      return; // the same run, resumed after its last frame
    if (kept.empty())
      setAside(folder);
  }
  removeFrames(folder, kept);
  if (!has_images)
    removeEmpty(folder, imageFolders());
  removeEmpty(folder, {std::begin(map_files), std::end(map_files)});
  removeLive(folder);
  const nlohmann::ordered_json unfinished{
      {"finished", false}, {"versions", {{"pcl_semantic", PCL_SEMANTIC_VERSION}}}};
  writeTextFile(folder + "/summary.json", jsonText(unfinished));
}

void
RunFolder::endRun(const std::string& folder, bool is_whole)
{
  removeLive(folder);
  if (is_whole)
    removePrevious(folder);
}

} // namespace pcl_semantic
