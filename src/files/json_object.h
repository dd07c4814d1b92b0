// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <pcl_semantic/core/label_set.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief Reads a JSON file.
 * \throws BadInputException if it cannot be read or parsed */
nlohmann::json readJson(const std::string& path);

/** \brief A short text of a value, for messages. */
std::string textOf(const nlohmann::json& value);

/** \brief A list of numbers.
 * \param[in] place file and key, for messages
 * \param[in] count of numbers; 0 = any
 * \throws BadInputException if the value is no such list */
std::vector<double> numbersFrom(const nlohmann::json& list, const std::string& place,
                                std::size_t count);

nlohmann::ordered_json jsonOf(const Eigen::Vector3d& vector);

/** \brief Begins the entry of a list of things: id, label and, if there is one, the
 * class's name. */
nlohmann::ordered_json entryOf(std::uint32_t id, Label label,
                               const LabelSet& label_set);

/** \brief Writes a list as the only value of a JSON file.
 * \throws OutputException if the file cannot be written */
void writeList(const std::string& path, const std::string& key,
               const nlohmann::ordered_json& list);

/** \brief Refuses an id that an earlier element of a list has.
 * \param[in,out] numbers ids of the earlier elements */
void requireNewId(std::uint32_t id, const std::string& place,
                  std::set<std::uint32_t>& numbers);

/** \brief An object of a JSON file. Messages name the file and the key. */
class JsonObject {
public:
  // \param[in] place file and key of the object
  JsonObject(const nlohmann::json& json, std::string place)
      : json_(json), place_(std::move(place))
  {
    if (!json.is_object())
      badInput(place_, ": got ", textOf(json), ", expected an object");
  }

  bool
  has(const char* key) const
  {
    return json_.contains(key);
  }

  const nlohmann::json&
  at(const char* key) const
  {
    if (!has(key))
      badInput(place_, ": has no ", key);
    return json_[key];
  }

  JsonObject
  object(const char* key) const
  {
    return {at(key), placeOf(key)};
  }

  // The place of a value, for messages.
  std::string
  placeOf(const char* key) const
  {
    return place_ + (place_.find(": ") == std::string::npos ? ": " : ".") + key;
  }

  // Calls `visit` with each element of a list and its place.
  template <typename Visit>
  void
  forEach(const char* key, Visit&& visit) const
  {
    const nlohmann::json& list = at(key);
    if (!list.is_array())
      refuse(key, list, "a list");
    for (std::size_t i = 0; i < list.size(); ++i)
      visit(list[i], placeOf(key) + "[" + std::to_string(i) + "]");
  }

  template <typename Number>
  Number
  whole(const char* key, Number least, Number most) const
  {
    const nlohmann::json& value = at(key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() < least ||
        value.get<std::uint64_t>() > most)
      refuse(key, value, least, " to ", most);
    return Number(value.get<std::uint64_t>());
  }

  int
  frame(const char* key, unsigned least = 0) const
  {
    return int(whole(key, least, unsigned(std::numeric_limits<int>::max())));
  }

  double
  number(const char* key) const
  {
    if (!at(key).is_number())
      refuse(key, at(key), "a number");
    return at(key).get<double>();
  }

  double
  notNegative(const char* key) const
  {
    if (number(key) < 0.0)
      refuse(key, at(key), "0 or more");
    return number(key);
  }

  // \param[in] count of numbers; 0 = any
  std::vector<double>
  numbers(const char* key, std::size_t count) const
  {
    return numbersFrom(at(key), placeOf(key), count);
  }

  Eigen::Vector3d
  vector(const char* key) const
  {
    return Eigen::Vector3d(numbers(key, 3).data());
  }

  std::string
  text(const char* key) const
  {
    if (!at(key).is_string())
      refuse(key, at(key), "a text");
    return at(key).get<std::string>();
  }

  // The id and label of entryOf(). The class has to be that of the label set, if both
  // have one.
  // \param[in] least label
  template <typename Thing>
  void
  readEntry(Thing& thing, unsigned least, const LabelSet& label_set) const
  {
    const unsigned classes = label_set.size() > 0 ? unsigned(label_set.size()) : 255;
    thing.id = whole("id", 1u, std::numeric_limits<std::uint32_t>::max());
    thing.label = Label(whole("label", least, classes));
    const Label label = thing.label;
    if (label != kUnlabelled && label_set.size() > 0 && has("class") &&
        text("class") != label_set[label].name)
      refuse("class", at("class"), label_set[label].name, ", the name of label ",
             int(label), " in the label set");
  }

  template <typename... Parts>
  [[noreturn]] void
  refuse(const char* key, const nlohmann::json& value, const Parts&... expected) const
  {
    badInput(placeOf(key), ": got ", textOf(value), ", expected ", expected...);
  }

private:
  const nlohmann::json& json_;
  std::string place_;
};

/** \brief Reads a list of objects with different ids.
 * \param[in] read makes a Thing with an `id` of a JsonObject
 * \throws BadInputException */
template <typename Thing, typename Read>
std::vector<Thing>
readList(const std::string& path, const char* key, Read&& read)
{
  const nlohmann::json json = readJson(path);
  std::vector<Thing> things;
  std::set<std::uint32_t> numbers;
  JsonObject(json, path)
      .forEach(key, [&](const nlohmann::json& thing, const std::string& place) {
        things.push_back(read(JsonObject(thing, place)));
        requireNewId(things.back().id, place, numbers);
      });
  return things;
}

} // namespace pcl_semantic
