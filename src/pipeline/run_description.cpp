// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/run_description.h>

#include "core/fail.h"
#include "core/split.h"
#include "io/run_values.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/version.h>

#include <opencv2/core/version.hpp>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

// FNV-1a: detects accidental changes, not forgery.
std::uint64_t
digestOf(const std::vector<std::uint8_t>& bytes)
{
  std::uint64_t digest = 0xCBF29CE484222325ull;
  for (const std::uint8_t byte : bytes)
    digest = (digest ^ byte) * 0x100000001B3ull;
  return digest;
}

std::string
describeInput(const std::string& value)
{
  std::error_code error;
  if (value.empty() || !fs::exists(value, error))
    return value;
  const fs::path path = fs::weakly_canonical(value, error);
  TextStream text;
  text << (error ? value : path.string());
  if (fs::is_regular_file(value, error))
    text << " (digest " << std::hex << digestOf(readBytes(value)) << ")";
  return text.str();
}

// Returns the shortest text that identifies a number.
std::string
exactText(double number)
{
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

// ConfigParameter::text() rounds.
std::string
exactText(const ConfigParameter& parameter)
{
  if (const auto* number = std::get_if<double*>(&parameter.value))
    return exactText(**number);
  if (const auto* vector = std::get_if<Eigen::Vector3d*>(&parameter.value))
    return exactText((*vector)->x()) + "," + exactText((*vector)->y()) + "," +
           exactText((*vector)->z());
  return parameter.text();
}

void
describeFrames(const std::vector<int>& frames, std::ostream& text)
{
  text << "frames: " << frames.size();
  if (!frames.empty())
    text << ", from " << frames.front() << " to " << frames.back();
  text << "\n";
}

void
describeCamera(const MappingRun& run, std::ostream& text)
{
  const StereoCamera camera = run.camera.value_or(StereoCamera());
  text << "camera:";
  for (const double value :
       {camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline})
    text << " " << exactText(value);
  text << " " << camera.width << "x" << camera.height << "\ncamera_pose:";
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      text << " " << exactText(run.T_camera0_camera(row, column));
  text << "\n";
}

void
describeLabelSet(const LabelSet& label_set, bool with_things, std::ostream& text)
{
  text << "classes: " << label_set.size() << "\n";
  for (int label = 1; label <= label_set.size(); ++label) {
    const LabelClass& each = label_set[Label(label)];
    text << "class_" << label << ": " << each.name;
    for (const std::uint8_t channel : each.colour)
      text << " " << int(channel);
    text << (each.sky ? " sky" : "") << (each.dynamic ? " dynamic" : "")
         << (each.thin ? " thin" : "");
    if (with_things && each.thing)
      text << " thing";
    if (with_things && each.gap > 0.0)
      text << " " << exactText(each.gap);
    text << "\n";
  }
}

bool
affectsMap(const std::string& parameter, const MapperConfig& config)
{
  const bool is_of_objects =
      parameter == "things" || parameter.rfind("object_", 0) == 0;
  return parameter != "threads" && (config.things || !is_of_objects);
}

} // namespace

std::string
describeRun(const MappingRun& run)
{
  TextStream text;
  // Other versions may round differently.
  text << "version: " << PCL_SEMANTIC_VERSION << ", OpenCV " << CV_VERSION << "\n";
  for (const auto& [name, value] : run.inputs)
    text << name << ": " << describeInput(value) << "\n";
  describeFrames(run.frames, text);
  describeCamera(run, text);
  describeLabelSet(run.label_set, run.config.things, text);
  MapperConfig config = run.config;
  for (const ConfigParameter& parameter : parametersOf(config))
    if (affectsMap(parameter.name, config))
      text << parameter.name << ": " << exactText(parameter) << "\n";
  return text.str();
}

std::string
changeOfRun(const std::string& before, const std::string& now)
{
  const auto old_values = runValues(before), new_values = runValues(now);
  const auto valueIn = [](const auto& values, const std::string& name) {
    const auto found = values.find(name);
    return found == values.end() || found->second.empty() ? "none" : found->second;
  };
  const std::string both = now + before; // in the order of the lines
  for (const std::string_view line : splitAt('\n', both)) {
    const std::string name(line.substr(0, line.find(": ")));
    const std::string was = valueIn(old_values, name), is = valueIn(new_values, name);
    if (was != is)
      return name + " was " + was + ", is " + is;
  }
  return {};
}

MapperConfig
configOf(const std::string& description)
{
  MapperConfig config;
  setFromRun(runValues(description), parametersOf(config));
  return config;
}

FrameRecord
recordOf(const MappedFrame& mapped)
{
  return {mapped.frame.number,
          mapped.T_world_camera,
          mapped.counts,
          mapped.times.seconds(),
          mapped.domain_shift,
          mapped.frame.timestamp,
          {}};
}

} // namespace pcl_semantic
