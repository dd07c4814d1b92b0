// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/pcd_table.h>

#include <algorithm>
#include <cstring>

namespace pcl_semantic {

namespace {

std::size_t
sizeOf(const PcdField& field)
{
  return static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.count);
}

std::size_t
offsetOf(const PcdTable& table, std::size_t field)
{
  std::size_t offset = 0;
  for (std::size_t i = 0; i < field; ++i)
    offset += sizeOf(table.fields[i]);
  return offset;
}

// Puts `inserted` bytes a point in the place of `removed` ones at `offset`.
void
replaceBytes(PcdTable& table, std::size_t offset, std::size_t removed,
             const std::uint8_t* values, std::size_t inserted)
{
  const std::size_t old_size = table.pointSize();
  const std::size_t new_size = old_size - removed + inserted;
  const std::size_t rest = old_size - offset - removed;
  std::vector<std::uint8_t> data(table.points * new_size);
  for (std::size_t i = 0; i < table.points; ++i) {
    const std::uint8_t* const from = table.data.data() + i * old_size;
    std::uint8_t* const to = data.data() + i * new_size;
    std::copy_n(from, offset, to);
    std::copy_n(values + i * inserted, inserted, to + offset);
    std::copy_n(from + offset + removed, rest, to + offset + inserted);
  }
  table.data = std::move(data);
}

template <typename T>
double
readAs(const std::uint8_t* bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

using Read = double (*)(const std::uint8_t*);

Read
readerOf(const PcdField& field)
{
  switch (field.size) {
  case 1:
    return field.type == 'I' ? readAs<std::int8_t> : readAs<std::uint8_t>;
  case 2:
    return field.type == 'I' ? readAs<std::int16_t> : readAs<std::uint16_t>;
  case 4:
    if (field.type == 'F')
      return readAs<float>;
    return field.type == 'I' ? readAs<std::int32_t> : readAs<std::uint32_t>;
  default:
    if (field.type == 'F')
      return readAs<double>;
    return field.type == 'I' ? readAs<std::int64_t> : readAs<std::uint64_t>;
  }
}

} // namespace

bool
PcdField::isValid() const
{
  const bool is_word =
      !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return static_cast<unsigned char>(c) > ' ' && c != '\x7F';
      });
  if (!is_word || count < 1 || count > kMaxPcdCount)
    return false;
  switch (type) {
  case 'F':
    return size == 4 || size == 8;
  case 'I':
  case 'U':
    return size == 1 || size == 2 || size == 4 || size == 8;
  case 'B':
    return size == 1;
  default:
    return false;
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
  const std::size_t size = sizeOf(field);
  if (!field.isValid() || values.size() != points * size ||
      data.size() != points * pointSize())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "field '" << field.name << "': " << values.size()
                                  << " bytes do not fit " << points << " points");
  const int index = find(field.name);
  if (index < 0) {
    replaceBytes(*this, pointSize(), 0, values.data(), size);
    fields.push_back(field);
    return;
  }
  PcdField& old = fields[static_cast<std::size_t>(index)];
  replaceBytes(*this, offsetOf(*this, static_cast<std::size_t>(index)), sizeOf(old),
               values.data(), size);
  old = field;
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
      kept.push_back({offset, sizeOf(field)});
      new_size += sizeOf(field);
    }
    offset += sizeOf(field);
  }
  if (data.size() != points * offset)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        data.size() << " bytes of data do not fit " << points
                                    << " points of " << offset);
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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "field " << field << " of " << table.fields.size()
                                 << " is not there, or its data");
  field_ = table.fields[index];
  first_ = table.data.data() + offsetOf(table, index);
  stride_ = table.pointSize();
  read_ = readerOf(field_);
}

std::uint32_t
PcdColumn::bits(std::size_t point) const
{
  if (field_.size != 4)
    PCL_THROW_EXCEPTION(InvalidParameterException, "field '" << field_.name << "' has "
                                                             << field_.size
                                                             << " bytes, expected 4");
  std::uint32_t value = 0;
  std::memcpy(&value, at(point, 0), sizeof(value));
  return value;
}

} // namespace pcl_semantic
