// SPDX-License-Identifier: BSD-3-Clause
#include "files/yaml_config.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_description.h>

#include <cmath>
#include <filesystem>

namespace pcl_semantic {

namespace {

constexpr int max_input_size = 8192;

std::string
pathBeside(const std::string& yaml_path, const std::string& path)
{
  return (std::filesystem::path(yaml_path).parent_path() / path)
      .lexically_normal()
      .string();
}

int
readSize(const YamlMap& input, const char* key)
{
  const int size = input.require<int>(key);
  if (size < 1 || size > max_input_size)
    PCL_THROW_EXCEPTION(BadInputException, input.where(key)
                                               << ": " << key << " is " << size
                                               << ", expected 1 to " << max_input_size);
  return size;
}

std::array<float, 3>
readColour(const YamlMap& file, const char* key)
{
  const auto values = file.require<std::vector<double>>(key);
  if (values.size() != 3)
    PCL_THROW_EXCEPTION(BadInputException, file.where(key)
                                               << ": expected [red, green, blue]");
  std::array<float, 3> colour{};
  for (int i = 0; i < 3; ++i) {
    colour[i] = static_cast<float>(values[i]);
    if (!std::isfinite(colour[i]))
      PCL_THROW_EXCEPTION(BadInputException, file.where(key)
                                                 << ": " << key << " is not finite");
  }
  return colour;
}

void
checkChannels(const YamlMap& file, const NetworkDescription& description)
{
  const LabelSet label_set = readLabelSet(description.label_set_path);
  if (description.channels.empty())
    PCL_THROW_EXCEPTION(BadInputException, file.where("channels")
                                               << ": the list is empty");
  for (std::size_t i = 0; i < description.channels.size(); ++i) {
    const std::string& name = description.channels[i];
    if (name != "-" && label_set.find(name) == kUnlabelled)
      PCL_THROW_EXCEPTION(BadInputException, file.where("channels")
                                                 << ": channel " << i << ": class '"
                                                 << name << "' is not in "
                                                 << description.label_set_path);
  }
}

} // namespace

NetworkDescription
readNetworkDescription(const std::string& yaml_path)
{
  const YamlMap file = YamlMap::load(yaml_path);
  NetworkDescription description;
  std::string model;
  if (file.get("model", model))
    description.model_path = pathBeside(yaml_path, model);
  description.label_set_path =
      pathBeside(yaml_path, file.require<std::string>("label_set"));

  const YamlMap input = file.requireMap("input");
  description.input_name = input.require<std::string>("name");
  description.input_width = readSize(input, "width");
  description.input_height = readSize(input, "height");
  input.refuseUnknownKeys();

  const YamlMap output = file.requireMap("output");
  description.output_name = output.require<std::string>("name");
  output.get("softmax", description.softmax);
  output.refuseUnknownKeys();

  description.mean = readColour(file, "mean");
  description.deviation = readColour(file, "deviation");
  for (const float deviation : description.deviation)
    if (deviation <= 0.0f)
      PCL_THROW_EXCEPTION(BadInputException, file.where("deviation")
                                                 << ": expected more than 0, not "
                                                 << deviation);
  description.channels = file.require<std::vector<std::string>>("channels");
  file.refuseUnknownKeys();
  checkChannels(file, description);
  return description;
}

} // namespace pcl_semantic
