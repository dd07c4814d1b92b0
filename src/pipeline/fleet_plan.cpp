// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/fleet_plan.h>

#include "core/fail.h"
#include "files/yaml_config.h"

#include <algorithm>
#include <set>

namespace pcl_semantic {

namespace {

using Options = std::vector<std::pair<std::string, std::string>>;

// What the fleet says itself, and what its submaps do not write.
const std::set<std::string> own_options = {
    "also",   "archive", "archive_every", "centres", "help",         "json",
    "live",   "man",     "map_only",      "output",  "print_config", "quiet",
    "resume", "verbose", "version",       "view"};

void
addOptions(const YamlMap& map, const std::set<std::string>& others, Options& options)
{
  for (const std::string& key : map.keys()) {
    if (others.count(key) > 0)
      continue;
    std::string name = key;
    std::replace(name.begin(), name.end(), '-', '_');
    if (own_options.count(name) > 0)
      badInput(map.where(key), ": '", key, "' is no option of a drive");
    options.emplace_back(name, map.require<std::string>(key));
  }
}

// Letters, digits, and what does not lead out of a folder.
bool
isFolderName(const std::string& name)
{
  constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                  "0123456789_-.";
  return !name.empty() && name.front() != '.' && name.size() <= 100 &&
         name.find_first_not_of(allowed) == std::string::npos;
}

FleetDrive
readDrive(const YamlMap& entry, const Options& options)
{
  FleetDrive drive;
  drive.name = entry.require<std::string>("name");
  if (!isFolderName(drive.name))
    badInput(entry.where("name"), ": '", drive.name,
             "', expected letters, digits, '_', '-' and '.'");
  entry.get("corrected_poses", drive.corrected_poses);
  Options own;
  addOptions(entry, {"name", "corrected_poses"}, own);
  for (const auto& option : options) {
    bool is_own = false;
    for (const auto& [key, value] : own)
      is_own = is_own || key == option.first;
    if (!is_own)
      drive.options.push_back(option);
  }
  drive.options.insert(drive.options.end(), own.begin(), own.end());
  return drive;
}

} // namespace

FleetPlan
readFleetPlan(const std::string& path)
{
  const YamlMap file = YamlMap::load(path);
  FleetPlan plan;
  plan.output = file.require<std::string>("output");
  if (plan.output.empty())
    badInput(file.where("output"), ": is empty, expected a folder");
  Options options;
  if (file.has("options"))
    addOptions(file.requireMap("options"), {}, options);
  std::set<std::string> names;
  for (const YamlMap& entry : file.requireList("drives")) {
    plan.drives.push_back(readDrive(entry, options));
    if (!names.insert(plan.drives.back().name).second)
      badInput(entry.where("name"), ": there is a drive '", plan.drives.back().name,
               "' already");
  }
  file.refuseUnknownKeys();
  if (plan.drives.empty())
    badInput(file.where("drives"), ": there is no drive");
  return plan;
}

} // namespace pcl_semantic
