// SPDX-License-Identifier: BSD-3-Clause
#include "known_fields.h"
#include "table_parts.h"

#include "core/fail.h"
#include "core/label_number.h"
#include "core/probability_sums.h"

#include <boost/algorithm/string/case_conv.hpp>
#include <pcl/common/io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>

namespace pcl_semantic {

namespace {

using Words = std::vector<std::string>;

// In order of priority.
const Words&
labelNames()
{
  static const Words names = {
      "label",          "labels",         "semantic_label", "sem_label", "class_label",
      "semantic",       "semantics",      "semantic_class", "sem_class", "semantic_id",
      "label_id",       "class",          "class_id",       "category",  "category_id",
      "classification", "classification_"};
  return names;
}

const Words&
probabilityNames()
{
  static const Words names = {"probability", "probabilities", "prob", "probs",
                              "softmax"};
  return names;
}

// Lower case, without CloudCompare's prefix.
std::string
spelled(const std::string& name)
{
  std::string result = boost::algorithm::to_lower_copy(name);
  for (const std::string prefix : {"scalar_", "sf_"})
    if (result.compare(0, prefix.size(), prefix) == 0)
      result.erase(0, prefix.size());
  return result;
}

// Whether a word of a name (split at underscores and similar) is one of these.
bool
hasWord(const std::string& name, const Words& words)
{
  std::string word;
  for (const char c : boost::algorithm::to_lower_copy(name) + "_") {
    if (c >= 'a' && c <= 'z') {
      word += c;
      continue;
    }
    if (std::count(words.begin(), words.end(), word))
      return true;
    word.clear();
  }
  return false;
}

// Warns of one field whose name resembles a missing one, and suggests the spelling.
void
doubtOfLookalike(const std::string& path, const char* what, const Words& words,
                 const std::string& expected_names, PcdTable& table)
{
  for (const pcl::PCLPointField& field : table.fields)
    if (hasWord(field.name, words))
      return addDoubt(table, path + ": field '" + field.name + "' is not read as " +
                                 what + "; expected " + expected_names);
}

std::vector<std::uint8_t>
columnBytes(const PcdTable& table, const pcl::PCLPointField& field)
{
  if (table.points() == 0)
    return {};
  const std::size_t size = sizeOfField(field);
  std::vector<std::uint8_t> bytes(table.points() * size);
  const std::uint8_t* from = table.data.data() + field.offset;
  for (std::uint8_t *to = bytes.data(), *end = to + bytes.size(); to != end;
       from += table.point_step)
    to = std::copy_n(from, size, to);
  return bytes;
}

template <typename T>
T
labelWithoutInstance(T value)
{
  if constexpr (std::is_floating_point_v<T>)
    return std::abs(value) <= T(4294967295.0) && value == std::floor(value)
               ? T(withoutInstance(std::int64_t(value)))
               : value;
  else if constexpr (sizeof(T) < 4)
    return value;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return value <= UINT32_MAX ? T(withoutInstance(std::int64_t(value))) : value;
  else
    return T(withoutInstance(std::int64_t(value)));
}

void
takeInstancesOff(PcdTable& table, const pcl::PCLPointField& field)
{
  if (field.count != 1 || table.points() == 0)
    return;
  std::uint8_t* const first = table.data.data() + field.offset;
  const std::size_t stride = table.point_step, points = table.points();
  withTypeOf(field, [&](auto zero) {
    using T = decltype(zero);
    for (std::size_t i = 0; i < points; ++i) {
      T value;
      std::memcpy(&value, first + i * stride, sizeof(T));
      const T kept = labelWithoutInstance(value);
      if (kept != value && value == value) {
        std::memcpy(first + i * stride, &kept, sizeof(T));
        table.instances.resize(points);
        table.instances[i] = std::uint16_t(std::uint32_t(std::int64_t(value)) >> 16);
      }
    }
  });
}

// Error text for a single-precision label field with inexact numbers; empty if all
// numbers are exact, or are no labels anyway.
std::string
textOfLostClass(const PcdColumn& column, std::size_t points)
{
  if (column.field().datatype != pcl::PCLPointField::FLOAT32 ||
      column.field().count != 1)
    return "";
  for (std::size_t i = 0; i < points; ++i) {
    const double number = std::abs(column(i));
    if (number >= kFirstInexactFloat && number <= 4294967295.0)
      return "point " + std::to_string(i) + " has " +
             std::to_string(std::int64_t(column(i))) +
             ", where single precision does not hold the class beside the instance; "
             "store whole numbers, or doubles";
  }
  return "";
}

// Warns of a second label field, unless it is empty or identical.
void
doubtOfOtherLabels(const std::string& path, const std::string& name, PcdTable& table)
{
  const PcdColumn labels(table, table.find("label"));
  for (std::size_t f = 0; f < table.fields.size(); ++f) {
    const std::string& other = table.fields[f].name;
    const Words& names = labelNames();
    if (other == name || other == "label" || table.fields[f].count != 1 ||
        !std::count(names.begin(), names.end(), spelled(other)))
      continue;
    const PcdColumn column(table, int(f));
    for (std::size_t i = 0; i < table.points(); ++i)
      if (column(i) != 0.0 && column(i) != labels(i))
        return addDoubt(table, path + ": field '" + other +
                                   "' is not read as labels: '" + name + "' is");
  }
}

void
addLabels(const std::string& path, PcdTable& table)
{
  const int found = findLabelField(table);
  if (found < 0) {
    if (table.find("probability") < 0)
      doubtOfLookalike(path, "labels",
                       {"label", "labels", "class", "classes", "semantic", "semantics",
                        "category", "classification"},
                       "label, labels, semantic, sem_class, class, category, "
                       "classification and the like (doc/formats.md)",
                       table);
    return;
  }
  const std::string name = table.fields[std::size_t(found)].name;
  const std::string lost = textOfLostClass(PcdColumn(table, found), table.points());
  if (name != "label") {
    const PcdColumn column(table, found);
    if (column.field().count != 1)
      return addDoubt(table, path + ": field '" + name +
                                 "' is not read as labels: they have COUNT 1");
    for (std::size_t i = 0; i < table.points(); ++i)
      if (!(std::abs(column(i)) <= 4294967295.0) || column(i) != std::floor(column(i)))
        return addDoubt(table, path + ": field '" + name +
                                   "' is not read as labels: they are whole numbers");
    if (!lost.empty())
      return addDoubt(table,
                      path + ": field '" + name + "' is not read as labels: " + lost);
    pcl::PCLPointField label = column.field();
    label.name = "label";
    const std::vector<std::uint8_t> bytes = columnBytes(table, column.field());
    table.setColumn(label, bytes.data(), bytes.size());
    table.label_source = name;
  }
  else if (!lost.empty())
    badInput(path, ": field 'label': ", lost);
  takeInstancesOff(table, table.fields[std::size_t(table.find("label"))]);
  doubtOfOtherLabels(path, name, table);
}

// Whether L x points numbers are distributions or all zero.
bool
areDistributions(const std::vector<float>& values, std::size_t classes)
{
  for (std::size_t i = 0; i < values.size(); i += classes) {
    double sum = 0.0;
    for (std::size_t k = i; k < i + classes; ++k) {
      if (!(values[k] >= 0.0f && values[k] <= 1.1f))
        return false;
      sum += double(values[k]);
    }
    if (!isSumOfProbabilities(sum))
      return false;
  }
  return true;
}

// The probability fields: one with several elements, or one per class, numbered from 0
// or 1.
std::vector<int>
probabilityFields(const PcdTable& table)
{
  const auto find = [&](const std::string& name) {
    for (std::size_t f = 0; f < table.fields.size(); ++f)
      if (spelled(table.fields[f].name) == name &&
          pcl::getFieldType(table.fields[f].datatype) == 'F')
        return int(f);
    return -1;
  };
  for (const std::string& name : probabilityNames()) {
    const int whole = find(name);
    if (whole >= 0 && table.fields[std::size_t(whole)].count > 1)
      return {whole};
    for (const char* const separator : {"_", ""})
      for (const int first : {0, 1}) {
        std::vector<int> fields;
        for (int k = first; fields.size() < 256; ++k) {
          const int field = find(name + separator + std::to_string(k));
          if (field < 0 || table.fields[std::size_t(field)].count != 1)
            break;
          fields.push_back(field);
        }
        if (fields.size() > 1)
          return fields;
      }
  }
  return {};
}

// The next numbered field after a gap in the numbering; empty if there is none.
std::string
fieldBehindGap(const PcdTable& table, const std::vector<int>& fields)
{
  const std::string last = table.fields[std::size_t(fields.back())].name;
  const std::size_t digits = last.find_last_not_of("0123456789") + 1;
  if (fields.size() < 2)
    return "";
  const int largest = std::stoi(last.substr(digits));
  for (int k = largest + 2; k < largest + 256; ++k)
    for (const pcl::PCLPointField& field : table.fields)
      if (field.name == last.substr(0, digits) + std::to_string(k))
        return field.name;
  return "";
}

void
addProbabilities(const std::string& path, PcdTable& table)
{
  if (table.find("probability") >= 0)
    return;
  const std::vector<int> fields = probabilityFields(table);
  if (fields.empty())
    return;
  std::vector<PcdColumn> columns;
  for (const int field : fields)
    columns.emplace_back(table, field);
  const int elements = int(columns[0].field().count);
  const std::size_t classes = columns.size() * std::size_t(elements);
  std::vector<float> values;
  values.reserve(table.points() * classes);
  for (std::size_t i = 0; i < table.points(); ++i)
    for (const PcdColumn& column : columns)
      for (int k = 0; k < elements; ++k)
        values.push_back(float(column(i, k)));
  const std::string name = columns[0].field().name;
  const std::string behind = fieldBehindGap(table, fields);
  if (!behind.empty())
    return addDoubt(table, path + ": field '" + name +
                               "' and those that follow are not read as "
                               "probabilities: between them and '" +
                               behind + "' a number is missing");
  if (classes > 255 || !areDistributions(values, classes))
    return addDoubt(table, path + ": field '" + name +
                               "' is not read as probabilities: they do not sum to 1");
  table.setColumn("probability", values, classes);
}

// Factor that scales a channel to 0..255; nothing if the numbers are no colours.
// Integers have 8 or 16 bits, regardless of their stored type.
std::optional<double>
scaleOf(const std::array<PcdColumn, 3>& channels, std::size_t points)
{
  double largest = 0.0;
  bool are_whole = true;
  std::size_t to_one = 0, beyond_one = 0;
  for (const PcdColumn& channel : channels)
    for (std::size_t i = 0; i < points; ++i) {
      const double value = channel(i);
      if (std::isnan(value))
        continue;
      if (!(value >= 0.0 && value <= 65535.0))
        return std::nullopt;
      largest = std::max(largest, value);
      are_whole = are_whole && value == std::floor(value);
      to_one += value > 0.0 && value <= 1.0;
      beyond_one += value > 1.0;
    }
  if (pcl::getFieldType(channels[0].field().datatype) == 'F' && largest <= 1.0)
    return 255.0;
  if (!are_whole && (largest <= 2.0 || to_one > beyond_one))
    return 255.0; // some exceed white
  if (largest <= 255.0)
    return 1.0;
  return are_whole ? std::optional(255.0 / 65535.0) : std::nullopt;
}

// Fields of red, green and blue; none if one is missing.
std::optional<std::array<PcdColumn, 3>>
colourChannels(const PcdTable& table)
{
  constexpr std::array<std::array<const char*, 3>, 3> words = {
      {{"red", "green", "blue"}, {"r", "g", "b"}, {"rf", "gf", "bf"}}};
  for (const auto& channels : words)
    for (const std::string prefix :
         {"", "diffuse_", "color_", "colour_", "vertex_", "rgb_"}) {
      std::vector<PcdColumn> found;
      for (const char* const channel : channels)
        for (std::size_t f = 0; f < table.fields.size(); ++f)
          if (spelled(table.fields[f].name) == prefix + channel &&
              table.fields[f].count == 1) {
            found.emplace_back(table, int(f));
            break;
          }
      if (found.size() == 3)
        return std::array<PcdColumn, 3>{found[0], found[1], found[2]};
    }
  return std::nullopt;
}

void
addColours(const std::string& path, PcdTable& table)
{
  if (table.find("rgb") >= 0 || table.find("rgba") >= 0)
    return;
  const auto channels = colourChannels(table);
  const std::string expected_names =
      "rgb or rgba of four bytes, red green blue or r g b "
      "(0 to 255, 0 to 65535, or floats 0 to 1)";
  if (!channels)
    return doubtOfLookalike(path, "colour",
                            {"red", "green", "blue", "rgb", "rgba", "bgr", "bgra",
                             "hsv", "color", "colour", "colors", "colours"},
                            expected_names, table);
  const auto scale = scaleOf(*channels, table.points());
  if (!scale)
    return addDoubt(table, path + ": field '" + (*channels)[0].field().name +
                               "' is not read as colour; expected " + expected_names);
  std::vector<std::uint32_t> colours(table.points(), 0xFF);
  std::size_t too_bright = 0;
  for (const PcdColumn& channel : *channels)
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const double value = channel(i) * *scale;
      too_bright += value > 255.0;
      colours[i] =
          colours[i] << 8 |
          (std::isnan(value) ? 0u : std::uint8_t(std::lround(std::min(value, 255.0))));
    }
  if (too_bright > 0)
    addDoubt(table,
             path + ": field '" + (*channels)[0].field().name +
                 "': " + std::to_string(too_bright) +
                 " of its colours are above 1, expected 0 to 1; 1 is used for them");
  table.setColumn("rgba", colours);
}

} // namespace

void
addDoubt(PcdTable& table, const std::string& doubt)
{
  if (!std::count(table.doubts.begin(), table.doubts.end(), doubt))
    table.doubts.push_back(doubt);
}

int
findLabelField(const pcl::PCLPointCloud2& cloud)
{
  int found = pcl::getFieldIndex(cloud, "label");
  for (const std::string& wanted : labelNames())
    for (std::size_t f = 0; f < cloud.fields.size() && found < 0; ++f)
      if (spelled(cloud.fields[f].name) == wanted)
        found = int(f);
  return found;
}

std::vector<int>
findProbabilityFields(const PcdTable& table)
{
  const int whole = table.find("probability");
  return whole >= 0 ? std::vector<int>{whole} : probabilityFields(table);
}

void
addKnownFields(const std::string& path, PcdTable& table)
{
  addProbabilities(path, table);
  addLabels(path, table);
  addColours(path, table);
}

} // namespace pcl_semantic
