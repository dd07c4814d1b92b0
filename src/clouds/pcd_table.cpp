// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/clouds/pcd_table.h>

#include "table_parts.h"

#include "core/fail.h"

#include <pcl/common/io.h>

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
isWithin(const pcl::PCLPointField& field, std::size_t point_step)
{
  return field.offset + sizeOfField(field) <= point_step;
}

bool
hasAllData(const PcdTable& table)
{
  return table.data.size() == table.points() * table.point_step;
}

void
requireBytes(const pcl::PCLPointCloud2& cloud)
{
  if (cloud.width == 0 || cloud.height == 0)
    return;
  if (cloud.is_bigendian)
    badParameter("cloud: got big-endian data, expected little-endian");
  const std::size_t row = std::size_t(cloud.width) * cloud.point_step;
  if (std::size_t(cloud.height) * cloud.row_step > cloud.data.size() &&
      std::size_t(cloud.height) * row <= cloud.data.size())
    badParameter("cloud: row_step is ", cloud.row_step, ", too large for ",
                 cloud.data.size(), " bytes of ", cloud.height, " rows; expected ", row,
                 ": ", cloud.width, " points of ", cloud.point_step, " bytes");
  if (cloud.height > 1 && cloud.row_step < row)
    badParameter("cloud: row_step is ", cloud.row_step, ", expected at least ", row,
                 ": ", cloud.width, " points of ", cloud.point_step, " bytes");
  if (row == 0 ||
      cloud.data.size() / cloud.height < std::max<std::size_t>(row, cloud.row_step))
    badParameter("cloud: has ", cloud.data.size(), " bytes for ", cloud.width, " x ",
                 cloud.height, " points of ", cloud.point_step);
}

} // namespace

bool
isPcdField(const pcl::PCLPointField& field)
{
  const auto is_printed = [](unsigned char c) { return c > ' ' && c != '\x7F'; };
  return !field.name.empty() &&
         std::all_of(field.name.begin(), field.name.end(), is_printed) &&
         field.count >= 1 && field.count <= kMaxPcdCount &&
         pcl::getFieldSize(field.datatype) > 0;
}

std::size_t
sizeOfField(const pcl::PCLPointField& field)
{
  return std::size_t(pcl::getFieldSize(field.datatype)) * field.count;
}

void
checkTable(const std::string& path, const PcdTable& table)
{
  std::set<std::string> names;
  bool fits = !table.fields.empty() && hasAllData(table);
  for (const pcl::PCLPointField& field : table.fields)
    fits = fits && isPcdField(field) && names.insert(field.name).second &&
           isWithin(field, table.point_step);
  if (!fits)
    badParameter(path, ": ", table.data.size(),
                 " bytes of data do not fit the fields of ", table.points(), " points");
  for (const double value : table.viewpoint)
    if (!std::isfinite(value))
      badParameter(path, ": the viewpoint is not finite");
}

PcdTable::PcdTable(const pcl::PCLPointCloud2& cloud)
{
  requireBytes(cloud);
  header = cloud.header;
  is_dense = cloud.is_dense;
  width = cloud.width;
  height = cloud.height;
  std::vector<std::pair<std::size_t, std::size_t>> columns; // offset and size
  for (pcl::PCLPointField field : cloud.fields) {
    if (field.name == kPadding)
      continue;
    field.count = std::max<pcl::uindex_t>(field.count, 1);
    if (!isPcdField(field))
      badParameter("cloud: field '", field.name, "' has type ", int(field.datatype),
                   " and count ", field.count, ", expected a field of .pcd");
    if (find(field.name) >= 0)
      badParameter("cloud: has two fields '", field.name, "'");
    // PCL's filters set point_step to 0 if no point is left.
    if (points() > 0 && !isWithin(field, cloud.point_step))
      badParameter("cloud: field '", field.name, "' ends beyond its point");
    addField(field.name, field.datatype, field.count);
    columns.emplace_back(field.offset, sizeOfField(field));
  }
  row_step = width * point_step;
  data.resize(points() * point_step);
  std::uint8_t* to = data.data();
  for (std::size_t row = 0; row < height; ++row)
    for (std::size_t column = 0; column < width; ++column) {
      const std::uint8_t* const point =
          cloud.data.data() + row * cloud.row_step + column * cloud.point_step;
      for (const auto& [offset, size] : columns)
        to = std::copy_n(point + offset, size, to);
    }
}

int
PcdTable::find(const std::string& name) const
{
  return pcl::getFieldIndex(*this, name);
}

void
PcdTable::addField(const std::string& name, std::uint8_t datatype, std::size_t count)
{
  fields.push_back({name, point_step, datatype, pcl::uindex_t(count)});
  if (!isWithin(fields.back(), kMaxPcdPointSize))
    badParameter("field '", name, "': points have more than ", kMaxPcdPointSize,
                 " bytes");
  point_step += pcl::uindex_t(sizeOfField(fields.back()));
}

void
PcdTable::setColumn(pcl::PCLPointField field, const void* values, std::size_t bytes)
{
  const std::size_t count = points(), size = sizeOfField(field);
  const int found = find(field.name);
  const std::size_t index = found < 0 ? fields.size() : std::size_t(found);
  const bool needs_room = found < 0 || size > sizeOfField(fields[index]);
  if (!isPcdField(field) || bytes != count * size || !hasAllData(*this) ||
      (needs_room && point_step + size > kMaxPcdPointSize))
    badParameter("field '", field.name, "': ", bytes, " bytes do not fit ", count,
                 " points");
  field.offset = needs_room ? point_step : fields[index].offset;
  if (needs_room) {
    std::vector<std::uint8_t> rows(count * (point_step + size));
    for (std::size_t i = 0; i < count; ++i)
      std::copy_n(data.data() + i * point_step, point_step,
                  rows.data() + i * (point_step + size));
    data = std::move(rows);
    point_step += pcl::uindex_t(size);
    row_step = width * point_step;
  }
  fields.resize(std::max(fields.size(), index + 1));
  fields[index] = field;
  const auto* const from = static_cast<const std::uint8_t*>(values);
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(from + i * size, size, data.data() + i * point_step + field.offset);
}

void
PcdTable::removeColumns(const std::string& name)
{
  const auto is_it = [&](const pcl::PCLPointField& each) { return each.name == name; };
  fields.erase(std::remove_if(fields.begin(), fields.end(), is_it), fields.end());
}

PcdColumn::PcdColumn(const PcdTable& table, int field)
{
  const auto index = static_cast<std::size_t>(field);
  if (field < 0 || index >= table.fields.size() || !isPcdField(table.fields[index]) ||
      !isWithin(table.fields[index], table.point_step) || !hasAllData(table))
    badParameter("field ", field, " of ", table.fields.size(),
                 " is missing or has no data");
  field_ = table.fields[index];
  size_ = std::size_t(pcl::getFieldSize(field_.datatype));
  first_ = table.points() == 0 ? nullptr : table.data.data() + field_.offset;
  stride_ = table.point_step;
  read_ = withTypeOf(field_, [](auto zero) { return &readAs<decltype(zero)>; });
}

std::uint32_t
PcdColumn::bits(std::size_t point) const
{
  if (size_ != 4)
    badParameter("field '", field_.name, "' has ", size_, " bytes, expected 4");
  std::uint32_t value = 0;
  std::memcpy(&value, at(point, 0), sizeof(value));
  return value;
}

} // namespace pcl_semantic
