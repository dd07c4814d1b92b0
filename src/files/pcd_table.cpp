// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_table.h"
#include "core/fail.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace pcl_semantic {

namespace {

template <typename T>
double
readAs(const std::uint8_t* bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

bool
hasValidFields(const PcdTable& table)
{
  std::set<std::string> names;
  for (const PcdField& field : table.fields)
    if (!field.isValid() ||
        (field.name != kPadding && !names.insert(field.name).second))
      return false;
  return !table.fields.empty() && table.pointSize() <= kMaxPcdPointSize;
}

bool
isOrganizedRight(const PcdTable& table)
{
  if (table.width == 0 || table.height == 0)
    return table.points == 0 || (table.width == 0 && table.height == 0);
  return table.points % table.height == 0 && table.points / table.height == table.width;
}

} // namespace

std::size_t
offsetOf(const PcdTable& table, std::size_t field)
{
  std::size_t offset = 0;
  for (std::size_t i = 0; i < field; ++i)
    offset += table.fields[i].bytes();
  return offset;
}

void
checkTable(const std::string& path, const PcdTable& table)
{
  if (!hasValidFields(table) || table.data.size() != table.points * table.pointSize())
    badParameter(path, ": ", table.data.size(),
                 " bytes of data do not fit the fields of ", table.points, " points");
  if (!isOrganizedRight(table))
    badParameter(path, ": ", table.width, " x ", table.height, " are not ",
                 table.points, " points");
  for (const double value : table.viewpoint)
    if (!std::isfinite(value))
      badParameter(path, ": the viewpoint is not finite");
}

bool
PcdField::isValid() const
{
  const auto is_printed = [](unsigned char c) { return c > ' ' && c != '\x7F'; };
  if (name.empty() || !std::all_of(name.begin(), name.end(), is_printed) || count < 1 ||
      count > kMaxPcdCount)
    return false;
  switch (type) {
  case 'F':
    return size == 4 || size == 8;
  case 'I':
  case 'U':
    return size == 1 || size == 2 || size == 4 || size == 8;
  default:
    return type == 'B' && size == 1;
  }
}

std::size_t
PcdTable::pointSize() const
{
  return offsetOf(*this, fields.size());
}

int
PcdTable::find(const std::string& name) const
{
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].name == name)
      return static_cast<int>(i);
  return -1;
}

void
PcdTable::setColumn(const PcdField& field, const std::vector<std::uint8_t>& values)
{
  const std::size_t inserted = field.bytes(), old_size = pointSize();
  if (!field.isValid() || values.size() != points * inserted ||
      data.size() != points * old_size)
    badParameter("field '", field.name, "': ", values.size(), " bytes do not fit ",
                 points, " points");
  const int found = find(field.name);
  const std::size_t index = found < 0 ? fields.size() : std::size_t(found);
  const std::size_t offset = offsetOf(*this, index);
  const std::size_t end = found < 0 ? offset : offset + fields[index].bytes();
  std::vector<std::uint8_t> rows(points * (old_size - (end - offset) + inserted));
  std::uint8_t* to = rows.data();
  for (std::size_t i = 0; i < points; ++i) {
    const std::uint8_t* const from = data.data() + i * old_size;
    to = std::copy_n(from, offset, to);
    to = std::copy_n(values.data() + i * inserted, inserted, to);
    to = std::copy_n(from + end, old_size - end, to);
  }
  data = std::move(rows);
  if (found < 0)
    fields.push_back(field);
  else
    fields[index] = field;
}

void
PcdTable::removeColumns(const std::string& name)
{
  // In one pass: a hostile header may name thousands of columns.
  struct Range {
    std::size_t offset, size;
  };
  std::vector<Range> kept;
  std::size_t offset = 0, new_size = 0;
  for (const PcdField& field : fields) {
    if (field.name != name) {
      kept.push_back({offset, field.bytes()});
      new_size += field.bytes();
    }
    offset += field.bytes();
  }
  if (data.size() != points * offset)
    badParameter(data.size(), " bytes of data do not fit ", points, " points of ",
                 offset);
  std::uint8_t* to = data.data();
  for (std::size_t i = 0; i < points; ++i)
    for (const Range& range : kept)
      to = std::copy_n(data.data() + i * offset + range.offset, range.size, to);
  data.resize(points * new_size);
  fields.erase(
      std::remove_if(fields.begin(), fields.end(),
                     [&](const PcdField& field) { return field.name == name; }),
      fields.end());
}

PcdColumn::PcdColumn(const PcdTable& table, int field)
{
  const auto index = static_cast<std::size_t>(field);
  if (field < 0 || index >= table.fields.size() || !table.fields[index].isValid() ||
      table.data.size() != table.points * table.pointSize())
    badParameter("field ", field, " of ", table.fields.size(),
                 " is not there, or its data");
  field_ = table.fields[index];
  first_ = table.points == 0 ? nullptr : table.data.data() + offsetOf(table, index);
  stride_ = table.pointSize();
  read_ = withTypeOf(field_, [](auto zero) { return &readAs<decltype(zero)>; });
}

std::uint32_t
PcdColumn::bits(std::size_t point) const
{
  if (field_.size != 4)
    badParameter("field '", field_.name, "' has ", field_.size, " bytes, expected 4");
  std::uint32_t value = 0;
  std::memcpy(&value, at(point, 0), sizeof(value));
  return value;
}

} // namespace pcl_semantic
