// SPDX-License-Identifier: BSD-3-Clause
#include "wire_reader.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic {

WireReader::WireReader(const WireField& field, const std::string& path)
    : WireReader(field.data, field.size, path)
{
  requireType(field, WireField::bytes, path);
}

bool
WireReader::next(WireField& field)
{
  if (atEnd())
    return false;
  const std::uint64_t tag = readVarint();
  if (tag >> 32 != 0 || tag >> 3 == 0)
    PCL_THROW_EXCEPTION(BadModelException,
                        path_ << ": is no ONNX file, or damaged: wrong field number");
  field = WireField();
  field.number = static_cast<std::uint32_t>(tag >> 3);
  switch (tag & 7) {
  case WireField::varint:
    field.value = readVarint();
    break;
  case WireField::fixed64:
    field.type = WireField::fixed64;
    take(8, field);
    break;
  case WireField::bytes:
    field.type = WireField::bytes;
    take(readVarint(), field);
    break;
  case WireField::fixed32:
    field.type = WireField::fixed32;
    take(4, field);
    break;
  default:
    PCL_THROW_EXCEPTION(BadModelException,
                        path_ << ": is no ONNX file, or damaged: wrong type of field "
                              << field.number);
  }
  return true;
}

std::uint64_t
WireReader::readVarint()
{
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && at_ != end_; shift += 7) {
    const std::uint64_t byte = *at_++;
    if (shift == 63 && byte > 1)
      break;
    value |= (byte & 0x7F) << shift;
    if (byte < 0x80)
      return value;
  }
  PCL_THROW_EXCEPTION(BadModelException,
                      path_ << ": is no ONNX file, or damaged: a number is cut off");
}

void
WireReader::take(std::uint64_t size, WireField& field)
{
  if (size > static_cast<std::uint64_t>(end_ - at_))
    PCL_THROW_EXCEPTION(BadModelException,
                        path_ << ": is no ONNX file, or damaged: field " << field.number
                              << " states " << size << " bytes, " << (end_ - at_)
                              << " are left");
  field.data = at_;
  field.size = static_cast<std::size_t>(size);
  at_ += size;
}

void
requireType(const WireField& field, WireField::Type type, const std::string& path)
{
  if (field.type != type)
    PCL_THROW_EXCEPTION(BadModelException,
                        path << ": is no ONNX file, or damaged: wrong type of field "
                             << field.number);
}

std::string
textOf(const WireField& field)
{
  return std::string(field.data, field.data + field.size);
}

std::string
printable(const std::string& text)
{
  constexpr std::size_t longest = 80;
  std::string result = text.substr(0, longest);
  for (char& c : result)
    if (c < 0x20 || c > 0x7E)
      c = '?';
  return result;
}

} // namespace pcl_semantic
