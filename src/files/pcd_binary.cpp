// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_data.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cstring>

namespace pcl_semantic {

namespace {

// PCL fills the last page of a file; pages have up to 64 KiB.
void
checkBehindData(const std::string& path, std::string_view rest)
{
  constexpr std::size_t most = 65536;
  if (rest.size() > most || rest.find_first_not_of('\0') != std::string_view::npos)
    PCL_THROW_EXCEPTION(BadInputException, path << ": has " << rest.size()
                                                << " bytes behind the data of its "
                                                   "points");
}

// Bytes of all points, which fit 64 bits: points < 2^64 and what the file has are
// compared before they are multiplied.
std::size_t
dataSize(const std::string& path, const PcdTable& table, std::size_t available)
{
  const std::size_t size = table.pointSize();
  if (table.points > available / size)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": holds " << available << " bytes of data, expected "
                             << table.points << " points of " << size << " bytes");
  return table.points * size;
}

std::uint32_t
readUint32(std::string_view bytes)
{
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

// Field by field to point by point.
std::vector<std::uint8_t>
toRows(const PcdTable& table, const std::vector<std::uint8_t>& columns)
{
  const std::size_t row = table.pointSize();
  std::vector<std::uint8_t> rows(columns.size());
  const std::uint8_t* from = columns.data();
  std::size_t offset = 0;
  for (const PcdField& field : table.fields) {
    const auto size =
        static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.count);
    for (std::size_t i = 0; i < table.points; ++i, from += size)
      std::copy_n(from, size, rows.data() + i * row + offset);
    offset += size;
  }
  return rows;
}

std::vector<std::uint8_t>
decodeCompressed(const std::string& path, const PcdTable& table, std::string_view data)
{
  constexpr std::size_t sizes = 8, most_expansion = 88; // 3 bytes give up to 264
  if (data.size() < sizes)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": ends before the sizes of the compressed data");
  const std::size_t packed_size = readUint32(data);
  const std::size_t unpacked_size = readUint32(data.substr(4));
  data.remove_prefix(sizes);
  if (packed_size > data.size())
    PCL_THROW_EXCEPTION(BadInputException, path << ": holds " << data.size()
                                                << " bytes of compressed data, "
                                                   "expected "
                                                << packed_size);
  checkBehindData(path, data.substr(packed_size));
  const std::size_t expected = dataSize(path, table, packed_size * most_expansion);
  if (unpacked_size != expected)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": its compressed data are " << unpacked_size
                             << " bytes long, expected " << expected << " for "
                             << table.points << " points");
  std::vector<std::uint8_t> columns;
  if (!unpackLzf(data.substr(0, packed_size), expected, columns))
    PCL_THROW_EXCEPTION(BadInputException, path << ": its compressed data are damaged");
  return toRows(table, columns);
}

} // namespace

std::vector<std::uint8_t>
decodePcdBinary(const std::string& path, const PcdHeader& header, std::string_view file)
{
  const std::string_view data = file.substr(header.data_offset);
  if (header.encoding == PcdEncoding::binary_compressed)
    return decodeCompressed(path, header.table, data);
  const std::size_t size = dataSize(path, header.table, data.size());
  checkBehindData(path, data.substr(size));
  return {data.begin(), data.begin() + static_cast<std::ptrdiff_t>(size)};
}

bool
unpackLzf(std::string_view packed, std::size_t size, std::vector<std::uint8_t>& result)
{
  result.clear();
  result.reserve(size);
  for (std::size_t i = 0; i < packed.size();) {
    const std::size_t control = static_cast<std::uint8_t>(packed[i++]);
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > packed.size() - i || length > size - result.size())
        return false;
      result.insert(result.end(), packed.begin() + static_cast<std::ptrdiff_t>(i),
                    packed.begin() + static_cast<std::ptrdiff_t>(i + length));
      i += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (packed.size() - i < (length == 7 ? 2u : 1u))
      return false;
    if (length == 7)
      length += static_cast<std::uint8_t>(packed[i++]);
    length += 2;
    const std::size_t back =
        (control & 31) * 256 + static_cast<std::uint8_t>(packed[i++]) + 1;
    if (back > result.size() || length > size - result.size())
      return false;
    for (std::size_t k = 0; k < length; ++k) // may read what it has just written
      result.push_back(result[result.size() - back]);
  }
  return result.size() == size;
}

} // namespace pcl_semantic
