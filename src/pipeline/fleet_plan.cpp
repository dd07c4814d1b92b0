// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/fleet_plan.h>

#include "core/fail.h"
#include "files/yaml_parameters.h"

#include <pcl_semantic/files/config_file.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace pcl_semantic {

namespace {

// Sets the options of one drive, or of all drives.
void
setOptions(const YamlMap& map, const std::set<std::string>& other_keys,
           const std::filesystem::path& folder, FleetDrive& drive)
{
  ConfigParameters options = parametersOf(drive.inputs);
  for (const ConfigParameter& parameter : parametersOf(drive.config))
    options.push_back(parameter);
  options.push_back({"submap_every", "", &drive.submap_every});
  std::string config;
  options.push_back({"config", "", &config});
  for (const std::string& key : map.keys()) {
    const bool is_known =
        std::any_of(options.begin(), options.end(),
                    [&](const ConfigParameter& each) { return each.name == key; });
    const std::string why = whyRemoved(key);
    if (other_keys.count(key) == 0 && !is_known)
      badInput(map.where(key), ": '", key, "' is no option of a drive: ",
               why.empty() ? "doc/fleet.md lists the options" : why);
    if (!is_known)
      continue;
    std::string option = key;
    std::replace(option.begin(), option.end(), '_', '-');
    drive.inputs.given.insert(option);
  }
  if (map.get("config", config))
    readMapperConfig((folder / config).string(), drive.config);
  setParameters(map, options);
}

// Letters, digits and safe punctuation: the name must not leave its folder.
bool
isFolderName(const std::string& name)
{
  constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                  "0123456789_-.";
  return !name.empty() && name.front() != '.' && name.size() <= 100 &&
         name.find_first_not_of(allowed) == std::string::npos;
}

FleetDrive
readDrive(const YamlMap& entry, const std::filesystem::path& folder, FleetDrive drive)
{
  drive.name = entry.require<std::string>("name");
  if (!isFolderName(drive.name))
    badInput(entry.where("name"), ": '", drive.name,
             "', expected letters, digits, '_', '-' and '.'");
  entry.get("corrected_poses", drive.corrected_poses);
  setOptions(entry, {"name", "corrected_poses"}, folder, drive);
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
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  FleetDrive common;
  if (file.has("options"))
    setOptions(file.requireMap("options"), {}, folder, common);
  std::set<std::string> names;
  for (const YamlMap& entry : file.requireList("drives")) {
    plan.drives.push_back(readDrive(entry, folder, common));
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
