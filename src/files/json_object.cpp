// SPDX-License-Identifier: BSD-3-Clause
#include "json_object.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

namespace pcl_semantic {

nlohmann::json
readJson(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  try {
    return nlohmann::json::parse(bytes.begin(), bytes.end());
  }
  catch (const nlohmann::json::parse_error& error) {
    badInput(path, ": byte ", error.byte, " is no JSON");
  }
  catch (const nlohmann::json::exception&) {
    badInput(path, ": a number is out of range");
  }
}

std::string
textOf(const nlohmann::json& value)
{
  if (value.is_array())
    return "a list of " + std::to_string(value.size());
  if (value.is_object())
    return "an object";
  constexpr std::size_t most = 60; // letters
  const std::string text = value.dump();
  return text.size() > most ? text.substr(0, most) + "..." : text;
}

std::vector<double>
numbersFrom(const nlohmann::json& list, const std::string& place, std::size_t count)
{
  bool is_good = list.is_array() && (count == 0 || list.size() == count);
  for (std::size_t i = 0; is_good && i < list.size(); ++i)
    is_good = list[i].is_number();
  if (!is_good && count > 0)
    badInput(place, ": got ", textOf(list), ", expected ", count, " numbers");
  if (!is_good)
    badInput(place, ": got ", textOf(list), ", expected numbers");
  return list.get<std::vector<double>>();
}

nlohmann::ordered_json
jsonOf(const Eigen::Vector3d& vector)
{
  return {vector.x(), vector.y(), vector.z()};
}

nlohmann::ordered_json
entryOf(std::uint32_t id, Label label, const LabelSet& label_set)
{
  nlohmann::ordered_json json = {{"id", id}, {"label", int(label)}};
  if (label_set.size() > 0 && label != kUnlabelled)
    json["class"] = label_set[label].name;
  return json;
}

void
writeList(const std::string& path, const std::string& key,
          const nlohmann::ordered_json& list)
{
  writeTextFile(path, nlohmann::ordered_json{{key, list}}.dump(1) + "\n");
}

void
requireNewId(std::uint32_t id, const std::string& place,
             std::set<std::uint32_t>& numbers)
{
  if (!numbers.insert(id).second)
    badInput(place, ".id: got ", id, ", which an earlier one has");
}

} // namespace pcl_semantic
