// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/label_set_file.h>

#include "yaml_config.h"

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/input_file.h>

#include <cmath>
#include <iomanip>

namespace pcl_semantic {

namespace {

LabelClass
readClass(const YamlMap& entry)
{
  LabelClass result;
  result.name = entry.require<std::string>("name");
  const auto colour = entry.require<std::vector<int>>("colour");
  if (colour.size() != 3)
    badInput(entry.where("colour"), ": expected [red, green, blue]");
  for (int channel = 0; channel < 3; ++channel) {
    if (colour[channel] < 0 || colour[channel] > 255)
      badInput(entry.where("colour"), ": got ", colour[channel], ", expected 0 to 255");
    result.colour[channel] = static_cast<std::uint8_t>(colour[channel]);
  }
  entry.get("sky", result.sky);
  entry.get("dynamic", result.dynamic);
  entry.get("thin", result.thin);
  entry.get("thing", result.thing);
  entry.get("gap", result.gap);
  if (!(result.gap >= 0.0 && std::isfinite(result.gap)))
    badInput(entry.where("gap"), ": got ", result.gap, ", expected 0 or more [m]");
  if (result.gap > 0.0 && !result.thing)
    badInput(entry.where("gap"), ": is only for classes with thing: true");
  entry.refuseUnknownKeys();
  return result;
}

} // namespace

LabelSet
readLabelSet(const std::string& path)
{
  const YamlMap file = YamlMap::load(path);
  std::vector<LabelClass> classes;
  for (const YamlMap& entry : file.requireList("classes"))
    classes.push_back(readClass(entry));
  file.refuseUnknownKeys();
  try {
    return LabelSet(std::move(classes));
  }
  catch (const InvalidParameterException& error) {
    badInput(file.where("classes"), ": ", error.what());
  }
}

LabelSet
readLabelSetOrDefault(const std::string& path)
{
  return readLabelSet(path.empty() ? findDataFile("label_sets/kitti11.yaml") : path);
}

void
writeLabelSet(const std::string& path, const LabelSet& label_set)
{
  TextStream text;
  text << "classes:\n";
  for (int label = 1; label <= label_set.size(); ++label) {
    const LabelClass& each = label_set[Label(label)];
    text << "  - {name: " << std::quoted(each.name) << ", colour: ["
         << int(each.colour[0]) << ", " << int(each.colour[1]) << ", "
         << int(each.colour[2]) << "]" << (each.sky ? ", sky: true" : "")
         << (each.dynamic ? ", dynamic: true" : "") << (each.thin ? ", thin: true" : "")
         << (each.thing ? ", thing: true" : "");
    if (each.gap > 0.0)
      text << ", gap: " << each.gap;
    text << "}\n";
  }
  writeTextFile(path, text.str());
}

namespace {

void
setIds(const YamlMap& map, const std::string& key, Label label, LabelMapping& mapping)
{
  for (const int id : map.require<std::vector<int>>(key)) {
    if (id < 0 || id > 65535)
      badInput(map.where(key), ": id is ", id, ", expected 0 to 65535");
    if (mapping.has(static_cast<std::uint32_t>(id)))
      badInput(map.where(key), ": id ", id, " is there twice");
    mapping.set(static_cast<std::uint32_t>(id), label);
  }
}

} // namespace

LabelMapping
readLabelMapping(const std::string& path, const LabelSet& label_set)
{
  LabelMapping mapping;
  if (path == "zero_based") {
    constexpr std::uint32_t ignored = 255; // usual training convention: no class
    for (int label = 1; label <= label_set.size(); ++label)
      mapping.set(std::uint32_t(label - 1), Label(label));
    mapping.set(ignored, kUnlabelled);
    return mapping;
  }
  const bool is_name = path.find_first_of("./") == std::string::npos;
  const YamlMap file =
      YamlMap::load(is_name ? findDataFile("label_mappings/" + path + ".yaml") : path);
  const YamlMap classes = file.requireMap("classes");
  for (const std::string& name : classes.keys()) {
    const Label label = label_set.find(name);
    if (label == kUnlabelled)
      badInput(classes.where(name), ": class '", name, "' is not in the label set");
    setIds(classes, name, label, mapping);
  }
  if (file.has("unlabelled"))
    setIds(file, "unlabelled", kUnlabelled, mapping);
  file.refuseUnknownKeys();
  return mapping;
}

PixelMapping
readPixelMapping(const std::string& path, const LabelSet& label_set)
{
  if (path.empty())
    return {};
  if (path != "colours")
    return readLabelMapping(path, label_set);
  try {
    return ColourMapping(label_set);
  }
  catch (const InvalidParameterException& error) {
    badInput("label mapping colours: ", error.what());
  }
}

} // namespace pcl_semantic
