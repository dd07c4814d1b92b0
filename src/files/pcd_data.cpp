// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_data.h"
#include "clouds/table_parts.h"
#include "core/fail.h"
#include "core/parse_whole.h"

#include <pcl_semantic/files/input_file.h>

#include <pcl/common/io.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace pcl_semantic {

namespace {

enum class Outcome { done, no_number, out_of_range };

// Underflow becomes zero, overflow is refused; the double value distinguishes them.
Outcome
parseTiny(std::string_view word, float& value)
{
  double wide = 0.0;
  if (!parseWhole(word, wide) || std::abs(wide) > 1.0)
    return Outcome::out_of_range;
  value = static_cast<float>(wide);
  return Outcome::done;
}

template <typename T>
Outcome
parseElement(std::string_view word, std::uint8_t* bytes)
{
  if (word.size() > 1 && word[0] == '+' && word[1] != '-')
    word.remove_prefix(1);
  T value{};
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc::invalid_argument || rest != end)
    return Outcome::no_number;
  Outcome outcome = Outcome::done;
  if (error == std::errc::result_out_of_range) {
    outcome = Outcome::out_of_range;
    if constexpr (std::is_same_v<T, float>)
      outcome = parseTiny(word, value);
  }
  std::memcpy(bytes, &value, sizeof(value));
  return outcome;
}

struct Element {
  const pcl::PCLPointField* field;
  std::size_t size;
  Outcome (*parse)(std::string_view, std::uint8_t*);
};

std::vector<Element>
elementsOf(const PcdTable& table)
{
  std::vector<Element> elements;
  for (const pcl::PCLPointField& field : table.fields)
    elements.insert(elements.end(), field.count, withTypeOf(field, [&](auto zero) {
                      return Element{&field, sizeof zero, parseElement<decltype(zero)>};
                    }));
  return elements;
}

void
parsePoint(std::string_view line, const std::vector<Element>& elements,
           const std::string& path, int number, std::vector<std::uint8_t>& data)
{
  std::string_view rest = line;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto& [field, size, parse] = elements[i];
    const std::string_view word = takeWord(rest);
    if (word.empty())
      badInput(atLine(path, number), ": has ", i, " number(s), expected ",
               elements.size());
    std::uint8_t bytes[8];
    const Outcome outcome = parse(word, bytes);
    if (outcome != Outcome::done)
      badInput(atLine(path, number), ": ", inQuotes(word),
               outcome == Outcome::no_number ? " is not" : " is too large for",
               " a number of field ", inQuotes(field->name), ", type ",
               pcl::getFieldType(field->datatype), " of ", size, " bytes");
    data.insert(data.end(), bytes, bytes + size);
  }
  if (!takeWord(rest).empty())
    badInput(atLine(path, number), ": has more than ", elements.size(), " numbers");
}

std::vector<std::uint8_t>
decodeAscii(const std::string& path, const PcdHeader& header, std::string_view file)
{
  // An element takes at least two characters, so a wrong number of points does not
  // cause a large allocation.
  const std::vector<Element> elements = elementsOf(header.table);
  const std::size_t possible =
      (file.size() - header.data_offset + 1) / (2 * elements.size());
  std::vector<std::uint8_t> data;
  data.reserve(std::min(header.table.points(), possible) * header.table.point_step);
  std::size_t offset = header.data_offset, points = 0;
  for (int number = header.data_line + 1; offset < file.size(); ++number) {
    const std::string_view line = takeLine(file, offset);
    if (line.find_first_not_of(" \t") == std::string_view::npos)
      continue;
    if (points++ == header.table.points())
      badInput(atLine(path, number), ": is beyond the ", header.table.points(),
               " points of the header");
    parsePoint(line, elements, path, number, data);
  }
  if (points != header.table.points())
    badInput(path, ": has ", points, " points, expected ", header.table.points());
  return data;
}

std::uint32_t
readUint32(std::string_view bytes)
{
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

// Decompresses LZF. A control byte c < 32 precedes c + 1 literal bytes. Any other
// repeats earlier output: length (c >> 5) + 2, where 7 + 2 is extended by the next
// byte, from (c & 31) * 256 + next byte + 1 bytes back. False unless `packed` is
// complete and gives exactly `size` bytes.
bool
unpackLzf(std::string_view packed, std::size_t size, std::vector<std::uint8_t>& result)
{
  result.reserve(size);
  for (std::size_t i = 0; i < packed.size();) {
    const std::size_t control = static_cast<std::uint8_t>(packed[i++]);
    if (control < 32) {
      const std::string_view literal = packed.substr(i, control + 1);
      if (literal.size() <= control || literal.size() > size - result.size())
        return false;
      result.insert(result.end(), literal.begin(), literal.end());
      i += literal.size();
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
    for (std::size_t k = 0; k < length; ++k) // may overlap its own output
      result.push_back(result[result.size() - back]);
  }
  return result.size() == size;
}

// Converts fields to rows of points.
std::vector<std::uint8_t>
toRows(const PcdTable& table, const std::vector<std::uint8_t>& columns)
{
  std::vector<std::uint8_t> rows(columns.size());
  const std::uint8_t* from = columns.data();
  for (const pcl::PCLPointField& field : table.fields) {
    const std::size_t size = sizeOfField(field), points = table.points();
    for (std::size_t i = 0; i < points; ++i, from += size)
      std::copy_n(from, size, rows.data() + i * table.point_step + field.offset);
  }
  return rows;
}

std::vector<std::uint8_t>
decodeCompressed(const std::string& path, const PcdTable& table, std::string_view data)
{
  constexpr std::size_t sizes = 8, max_expansion = 88; // 3 bytes give up to 264
  if (data.size() < sizes)
    badInput(path, ": ends before the sizes of the compressed data");
  const std::size_t packed_size = readUint32(data);
  const std::size_t unpacked_size = readUint32(data.substr(4));
  data.remove_prefix(sizes);
  if (packed_size > data.size())
    badInput(path, ": holds ", data.size(), " bytes of compressed data, expected ",
             packed_size);
  checkBehindData(path, data.size() - packed_size, data.substr(packed_size));
  const std::size_t expected = binarySize(path, table, packed_size * max_expansion);
  if (unpacked_size != expected)
    badInput(path, ": its compressed data are ", unpacked_size,
             " bytes long, expected ", expected, " for ", table.points(), " points");
  std::vector<std::uint8_t> columns;
  if (!unpackLzf(data.substr(0, packed_size), expected, columns))
    badInput(path, ": its compressed data are damaged");
  return toRows(table, columns);
}

} // namespace

// No overflow: points < 2^64 and the file size are compared before multiplication.
std::size_t
binarySize(const std::string& path, const PcdTable& table, std::size_t available)
{
  const std::size_t points = table.points(), size = table.point_step;
  if (points > available / size)
    badInput(path, ": holds ", available, " bytes of data, expected ", points,
             " points of ", size, " bytes");
  return points * size;
}

void
checkBehindData(const std::string& path, std::size_t size, std::string_view first)
{
  if (size > kMaxBehindData || first.find_first_not_of('\0') != std::string_view::npos)
    badInput(path, ": has ", size, " bytes behind the data of its points");
}

std::vector<std::uint8_t>
decodeData(const std::string& path, const PcdHeader& header,
           std::vector<std::uint8_t> file)
{
  if (header.encoding == PcdEncoding::ascii)
    return decodeAscii(path, header, textOf(file));
  const std::string_view data = textOf(file).substr(header.data_offset);
  if (header.encoding == PcdEncoding::binary_compressed)
    return decodeCompressed(path, header.table, data);
  const std::size_t size = binarySize(path, header.table, data.size());
  checkBehindData(path, data.size() - size, data.substr(size));
  file.erase(file.begin(), file.begin() + std::ptrdiff_t(header.data_offset));
  file.resize(size);
  return file;
}

} // namespace pcl_semantic
