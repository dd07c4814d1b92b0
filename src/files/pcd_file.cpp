// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_file.h"
#include "pcd_data.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/pcd_table.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>

namespace pcl_semantic {

namespace {

using Words = std::vector<std::string_view>;

struct HeaderLine {
  Words words;
  int number = 0;
};

class HeaderParser {
public:
  HeaderParser(const std::string& path, std::string_view file)
      : path_(path), file_(file)
  {}

  PcdHeader
  parse()
  {
    collectLines();
    parseFields();
    parseSizes();
    if (has("VIEWPOINT"))
      parseViewpoint();
    if (has("VERSION"))
      oneOf("VERSION", {"0.7", ".7", "0.6", ".6", "0.5", ".5"}, "0.5 to 0.7");
    header_.encoding =
        static_cast<PcdEncoding>(oneOf("DATA", {"ascii", "binary", "binary_compressed"},
                                       "ascii, binary or binary_compressed"));
    return header_;
  }

private:
  bool
  has(const char* keyword) const
  {
    return lines_.count(keyword) > 0;
  }

  const HeaderLine&
  line(const char* keyword) const
  {
    const auto entry = lines_.find(keyword);
    if (entry == lines_.end())
      PCL_THROW_EXCEPTION(BadInputException,
                          path_ << ": the header has no " << keyword);
    return entry->second;
  }

  std::string
  where(const char* keyword) const
  {
    return atLine(path_, line(keyword).number) + ": " + keyword;
  }

  // The lines up to DATA, by their first words.
  void
  collectLines()
  {
    static const std::set<std::string_view> known = {
        "VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
        "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
    if (file_.empty())
      PCL_THROW_EXCEPTION(BadInputException, path_ << ": is empty");
    std::size_t offset = file_.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;
    for (int number = 1; offset < file_.size(); ++number) {
      std::string_view rest = takeLine(file_, offset);
      const std::string_view keyword = takeWord(rest);
      if (keyword == "#" && takeWord(rest) == "voxel_grid")
        parseVoxelGrid(rest);
      if (keyword.empty() || keyword[0] == '#')
        continue;
      if (!known.count(keyword))
        PCL_THROW_EXCEPTION(BadInputException,
                            atLine(path_, number) << ": " << inQuotes(keyword)
                                                  << " is no keyword of a .pcd header");
      const auto [entry, is_new] = lines_.try_emplace(keyword);
      if (!is_new)
        PCL_THROW_EXCEPTION(BadInputException, atLine(path_, number)
                                                   << ": " << keyword
                                                   << " for the second time");
      entry->second.number = number;
      for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest))
        entry->second.words.push_back(word);
      if (keyword == "DATA") {
        header_.data_offset = offset;
        header_.data_line = number;
        return;
      }
    }
    PCL_THROW_EXCEPTION(BadInputException, path_ << ": the header ends without DATA");
  }

  // A comment of anybody else may begin like ours: what does not fit says nothing.
  void
  parseVoxelGrid(std::string_view rest)
  {
    std::array<double, 4> grid;
    for (double& value : grid) {
      const std::string_view word = takeWord(rest);
      const char* const end = word.data() + word.size();
      const auto [stop, error] = std::from_chars(word.data(), end, value);
      if (error != std::errc() || stop != end || !std::isfinite(value))
        return;
    }
    if (grid[0] > 0.0)
      header_.table.voxel_grid = grid;
  }

  const Words&
  words(const char* keyword, std::size_t count) const
  {
    const Words& found = line(keyword).words;
    if (found.size() != count)
      PCL_THROW_EXCEPTION(BadInputException, where(keyword)
                                                 << " has " << found.size()
                                                 << " value(s), expected " << count);
    return found;
  }

  std::size_t
  number(const char* keyword, std::string_view word, std::size_t least,
         std::size_t most) const
  {
    std::size_t value = 0;
    const auto [rest, error] =
        std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size() || value < least ||
        value > most)
      PCL_THROW_EXCEPTION(BadInputException, where(keyword)
                                                 << " is " << inQuotes(word)
                                                 << ", expected a whole number from "
                                                 << least << " to " << most);
    return value;
  }

  std::size_t
  oneOf(const char* keyword, const Words& allowed, const char* expected) const
  {
    const std::string_view word = words(keyword, 1)[0];
    for (std::size_t i = 0; i < allowed.size(); ++i)
      if (word == allowed[i])
        return i;
    PCL_THROW_EXCEPTION(BadInputException, where(keyword) << " is " << inQuotes(word)
                                                          << ", expected " << expected);
  }

  void
  parseFields()
  {
    const Words& names = line("FIELDS").words;
    if (names.empty())
      PCL_THROW_EXCEPTION(BadInputException, where("FIELDS") << " names none");
    const Words& sizes = words("SIZE", names.size());
    const Words& types = words("TYPE", names.size());
    const Words counts =
        has("COUNT") ? words("COUNT", names.size()) : Words(names.size(), "1");
    std::set<std::string_view> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] != "_" && !seen.insert(names[i]).second)
        PCL_THROW_EXCEPTION(BadInputException, where("FIELDS")
                                                   << " names " << inQuotes(names[i])
                                                   << " for the second time");
      PcdField field;
      field.name = std::string(names[i]);
      field.size = static_cast<int>(number("SIZE", sizes[i], 1, 8));
      field.count = static_cast<int>(number("COUNT", counts[i], 1, kMaxPcdCount));
      field.type = types[i].size() == 1 ? types[i][0] : '?';
      if (!field.isValid()) // sizes and counts are checked, and words have no blank
        PCL_THROW_EXCEPTION(BadInputException,
                            where("TYPE")
                                << ": field " << inQuotes(names[i]) << " is "
                                << inQuotes(types[i]) << " of " << field.size
                                << " bytes, expected a name, F (4 or 8), I or U (1, "
                                   "2, 4 or 8) or B (1)");
      header_.table.fields.push_back(field);
    }
    if (header_.table.pointSize() > kMaxPcdPointSize)
      PCL_THROW_EXCEPTION(BadInputException,
                          where("FIELDS")
                              << " make points of " << header_.table.pointSize()
                              << " bytes, expected at most " << kMaxPcdPointSize);
  }

  void
  parseSizes()
  {
    constexpr std::size_t most = UINT32_MAX; // so that the product fits 64 bits
    PcdTable& table = header_.table;
    table.width = number("WIDTH", words("WIDTH", 1)[0], 0, most);
    table.height = number("HEIGHT", words("HEIGHT", 1)[0], 0, most);
    table.points = table.width * table.height;
    if (has("POINTS") &&
        number("POINTS", words("POINTS", 1)[0], 0, SIZE_MAX) != table.points)
      PCL_THROW_EXCEPTION(BadInputException,
                          where("POINTS") << " is " << inQuotes(words("POINTS", 1)[0])
                                          << ", expected WIDTH x HEIGHT, which is "
                                          << table.points);
  }

  void
  parseViewpoint()
  {
    const Words& values = words("VIEWPOINT", header_.table.viewpoint.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      double value = 0.0;
      const auto [rest, error] =
          std::from_chars(values[i].data(), values[i].data() + values[i].size(), value);
      if (error != std::errc() || rest != values[i].data() + values[i].size() ||
          !std::isfinite(value))
        PCL_THROW_EXCEPTION(BadInputException, where("VIEWPOINT")
                                                   << ": " << inQuotes(values[i])
                                                   << " is not a finite number");
      header_.table.viewpoint[i] = value;
    }
  }

  const std::string& path_;
  std::string_view file_;
  std::map<std::string_view, HeaderLine> lines_;
  PcdHeader header_;
};

} // namespace

PcdHeader
parsePcdHeader(const std::string& path, std::string_view file)
{
  return HeaderParser(path, file).parse();
}

std::string_view
takeLine(std::string_view text, std::size_t& offset)
{
  const std::size_t end = std::min(text.find('\n', offset), text.size());
  std::string_view line = text.substr(offset, end - offset);
  offset = std::min(end + 1, text.size());
  if (!line.empty() && line.back() == '\r')
    line.remove_suffix(1);
  return line;
}

std::string_view
takeWord(std::string_view& line)
{
  constexpr std::string_view blanks = " \t";
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word =
      line.substr(0, std::min(line.find_first_of(blanks), line.size()));
  line.remove_prefix(word.size());
  return word;
}

namespace {

enum class Outcome { done, no_number, out_of_range };

// A number too small for its type is the type's zero, one too large is refused: the two
// are told apart in double.
Outcome
parseTiny(const char* begin, const char* end, float& value)
{
  double wide = 0.0;
  if (std::from_chars(begin, end, wide).ec != std::errc() || std::abs(wide) > 1.0)
    return Outcome::out_of_range;
  value = static_cast<float>(wide);
  return Outcome::done;
}

template <typename T>
Outcome
parseElement(std::string_view word, std::uint8_t* bytes)
{
  const char *begin = word.data(), *const end = begin + word.size();
  if (begin != end && *begin == '+' && begin + 1 != end && begin[1] != '-')
    ++begin;
  T value{};
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error == std::errc::invalid_argument || rest != end)
    return Outcome::no_number;
  if (error == std::errc::result_out_of_range) {
    if constexpr (std::is_same_v<T, float>) {
      const Outcome outcome = parseTiny(begin, end, value);
      if (outcome != Outcome::done)
        return outcome;
    }
    else
      return Outcome::out_of_range;
  }
  std::memcpy(bytes, &value, sizeof(value));
  return Outcome::done;
}

using Parse = Outcome (*)(std::string_view, std::uint8_t*);

Parse
parserOf(const PcdField& field)
{
  const bool is_signed = field.type == 'I', is_float = field.type == 'F';
  switch (field.size) {
  case 1:
    return is_signed ? parseElement<std::int8_t> : parseElement<std::uint8_t>;
  case 2:
    return is_signed ? parseElement<std::int16_t> : parseElement<std::uint16_t>;
  case 4:
    if (is_float)
      return parseElement<float>;
    return is_signed ? parseElement<std::int32_t> : parseElement<std::uint32_t>;
  default:
    if (is_float)
      return parseElement<double>;
    return is_signed ? parseElement<std::int64_t> : parseElement<std::uint64_t>;
  }
}

struct Element {
  const PcdField* field;
  Parse parse;
};

std::vector<Element>
elementsOf(const PcdTable& table)
{
  std::vector<Element> elements;
  for (const PcdField& field : table.fields)
    elements.insert(elements.end(), static_cast<std::size_t>(field.count),
                    {&field, parserOf(field)});
  return elements;
}

void
parsePoint(std::string_view line, const std::vector<Element>& elements,
           const std::string& path, int number, std::vector<std::uint8_t>& data)
{
  std::string_view rest = line;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const PcdField& field = *elements[i].field;
    const std::string_view word = takeWord(rest);
    if (word.empty())
      PCL_THROW_EXCEPTION(BadInputException, atLine(path, number)
                                                 << ": has " << i
                                                 << " number(s), expected "
                                                 << elements.size());
    std::uint8_t bytes[8];
    const Outcome outcome = elements[i].parse(word, bytes);
    if (outcome != Outcome::done)
      PCL_THROW_EXCEPTION(
          BadInputException,
          atLine(path, number)
              << ": " << inQuotes(word)
              << (outcome == Outcome::no_number ? " is not" : " is too large for")
              << " a number of field " << inQuotes(field.name) << ", type "
              << field.type << " of " << field.size << " bytes");
    data.insert(data.end(), bytes, bytes + field.size);
  }
  if (!takeWord(rest).empty())
    PCL_THROW_EXCEPTION(BadInputException, atLine(path, number)
                                               << ": has more than " << elements.size()
                                               << " numbers");
}

} // namespace

std::vector<std::uint8_t>
decodePcdAscii(const std::string& path, const PcdHeader& header, std::string_view file)
{
  // At least two characters an element: what a false number of points asks for is no
  // reason to allocate.
  const std::vector<Element> elements = elementsOf(header.table);
  const std::size_t size = header.table.pointSize();
  const std::size_t possible =
      (file.size() - header.data_offset + 1) / (2 * elements.size());
  std::vector<std::uint8_t> data;
  data.reserve(std::min(header.table.points, possible) * size);
  std::size_t offset = header.data_offset, points = 0;
  for (int number = header.data_line + 1; offset < file.size(); ++number) {
    const std::string_view line = takeLine(file, offset);
    if (line.find_first_not_of(" \t") == std::string_view::npos)
      continue;
    if (points++ == header.table.points)
      PCL_THROW_EXCEPTION(BadInputException, atLine(path, number)
                                                 << ": is beyond the "
                                                 << header.table.points
                                                 << " points of the header");
    parsePoint(line, elements, path, number, data);
  }
  if (points != header.table.points)
    PCL_THROW_EXCEPTION(BadInputException, path << ": has " << points
                                                << " points, expected "
                                                << header.table.points);
  return data;
}

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
  constexpr std::size_t sizes = 8, max_expansion = 88; // 3 bytes give up to 264
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
  const std::size_t expected = dataSize(path, table, packed_size * max_expansion);
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

namespace {

constexpr const char* kPadding = "_";

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

void
checkTable(const std::string& path, const PcdTable& table)
{
  if (!hasValidFields(table) || table.data.size() != table.points * table.pointSize())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        path << ": " << table.data.size()
                             << " bytes of data do not fit the fields of "
                             << table.points << " points");
  if (!isOrganizedRight(table))
    PCL_THROW_EXCEPTION(InvalidParameterException, path << ": " << table.width << " x "
                                                        << table.height << " are not "
                                                        << table.points << " points");
  for (const double value : table.viewpoint)
    if (!std::isfinite(value))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          path << ": the viewpoint is not finite");
}

} // namespace

PcdTable
decodePcd(const std::string& path, std::string_view file)
{
  PcdHeader header = parsePcdHeader(path, file);
  header.table.data = header.encoding == PcdEncoding::ascii
                          ? decodePcdAscii(path, header, file)
                          : decodePcdBinary(path, header, file);
  header.table.removeColumns(kPadding);
  if (header.table.fields.empty())
    PCL_THROW_EXCEPTION(BadInputException, path << ": has no field but padding");
  return std::move(header.table);
}

PcdTable
readPcd(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  return decodePcd(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void
writePcdHeader(std::ostream& stream, const PcdTable& table)
{
  const auto line = [&](const char* name,
                        const std::function<void(const PcdField&)>& print) {
    stream << name;
    for (const PcdField& field : table.fields) {
      stream << ' ';
      print(field);
    }
    stream << '\n';
  };
  stream << "# .PCD v0.7 - Point Cloud Data file format\n";
  if (table.voxel_grid[0] > 0.0) {
    stream.precision(15); // 0.1 is to be read as such
    stream << "# voxel_grid";
    for (const double value : table.voxel_grid)
      stream << ' ' << value;
    stream << '\n';
  }
  stream << "VERSION 0.7\n";
  line("FIELDS", [&](const PcdField& field) { stream << field.name; });
  line("SIZE", [&](const PcdField& field) { stream << field.size; });
  line("TYPE", [&](const PcdField& field) { stream << field.type; });
  line("COUNT", [&](const PcdField& field) { stream << field.count; });
  const bool is_list = table.width == 0 && table.height == 0;
  stream << "WIDTH " << (is_list ? table.points : table.width) << "\nHEIGHT "
         << (is_list ? 1 : table.height) << "\nVIEWPOINT";
  stream.precision(17);
  for (const double value : table.viewpoint)
    stream << ' ' << value;
  stream << "\nPOINTS " << table.points << "\nDATA binary\n";
}

void
writePcd(const std::string& path, const PcdTable& table)
{
  checkTable(path, table);
  AtomicFile file(path);
  writePcdHeader(file.stream(), table);
  file.stream().write(reinterpret_cast<const char*>(table.data.data()),
                      std::streamsize(table.data.size()));
  file.commit();
}

} // namespace pcl_semantic
