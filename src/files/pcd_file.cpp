// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_file.h"
#include "parse_whole.h"

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <type_traits>

namespace pcl_semantic {

namespace {

constexpr const char* kPadding = "_";

std::size_t
offsetOf(const PcdTable& table, std::size_t field)
{
  std::size_t offset = 0;
  for (std::size_t i = 0; i < field; ++i)
    offset += table.fields[i].bytes();
  return offset;
}

// What `use` gives for a zero of the type that a field holds.
template <typename Use>
auto
withTypeOf(const PcdField& field, Use&& use)
{
  const bool is_signed = field.type == 'I', is_float = field.type == 'F';
  switch (field.size) {
  case 1:
    return is_signed ? use(std::int8_t()) : use(std::uint8_t());
  case 2:
    return is_signed ? use(std::int16_t()) : use(std::uint16_t());
  case 4:
    if (is_float)
      return use(float());
    return is_signed ? use(std::int32_t()) : use(std::uint32_t());
  default:
    if (is_float)
      return use(double());
    return is_signed ? use(std::int64_t()) : use(std::uint64_t());
  }
}

using Read = double (*)(const std::uint8_t*);

template <typename T>
double
readAs(const std::uint8_t* bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

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
      badInput(path_, ": the header has no ", keyword);
    return entry->second;
  }

  template <typename... Parts>
  [[noreturn]] void
  refuse(const char* keyword, const Parts&... parts) const
  {
    badInput(atLine(path_, line(keyword).number), ": ", keyword, parts...);
  }

  // The lines up to DATA, by their first words.
  void
  collectLines()
  {
    static const std::set<std::string_view> known = {
        "VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
        "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
    if (file_.empty())
      badInput(path_, ": is empty");
    std::size_t offset = file_.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;
    for (int number = 1; offset < file_.size(); ++number) {
      std::string_view rest = takeLine(file_, offset);
      const std::string_view keyword = takeWord(rest);
      if (keyword == "#" && takeWord(rest) == "voxel_grid")
        parseVoxelGrid(rest);
      if (keyword.empty() || keyword[0] == '#')
        continue;
      const std::string where = atLine(path_, number) + ": ";
      if (!known.count(keyword))
        badInput(where, inQuotes(keyword), " is no keyword of a .pcd header");
      const auto [entry, is_new] = lines_.try_emplace(keyword);
      if (!is_new)
        badInput(where, keyword, " for the second time");
      entry->second.number = number;
      for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest))
        entry->second.words.push_back(word);
      if (keyword == "DATA") {
        header_.data_offset = offset;
        header_.data_line = number;
        return;
      }
    }
    badInput(path_, ": the header ends without DATA");
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
      refuse(keyword, " has ", found.size(), " value(s), expected ", count);
    return found;
  }

  std::size_t
  number(const char* keyword, std::string_view word, std::size_t least,
         std::size_t most) const
  {
    std::size_t value = 0;
    if (!parseWhole(word, value) || value < least || value > most)
      refuse(keyword, " is ", inQuotes(word), ", expected a whole number from ", least,
             " to ", most);
    return value;
  }

  std::size_t
  oneOf(const char* keyword, const Words& allowed, const char* expected) const
  {
    const std::string_view word = words(keyword, 1)[0];
    const auto found = std::find(allowed.begin(), allowed.end(), word);
    if (found == allowed.end())
      refuse(keyword, " is ", inQuotes(word), ", expected ", expected);
    return std::size_t(found - allowed.begin());
  }

  void
  parseFields()
  {
    const Words& names = line("FIELDS").words;
    if (names.empty())
      refuse("FIELDS", " names none");
    const Words& sizes = words("SIZE", names.size());
    const Words& types = words("TYPE", names.size());
    const Words counts =
        has("COUNT") ? words("COUNT", names.size()) : Words(names.size(), "1");
    std::set<std::string_view> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] != kPadding && !seen.insert(names[i]).second)
        refuse("FIELDS", " names ", inQuotes(names[i]), " for the second time");
      const PcdField field{std::string(names[i]),
                           types[i].size() == 1 ? types[i][0] : '?',
                           int(number("SIZE", sizes[i], 1, 8)),
                           int(number("COUNT", counts[i], 1, kMaxPcdCount))};
      if (!field.isValid()) // sizes and counts are checked, and words have no blank
        refuse("TYPE", ": field ", inQuotes(names[i]), " is ", inQuotes(types[i]),
               " of ", field.size,
               " bytes, expected a name, F (4 or 8), I or U (1, 2, 4 or 8) or B (1)");
      header_.table.fields.push_back(field);
    }
    if (header_.table.pointSize() > kMaxPcdPointSize)
      refuse("FIELDS", " make points of ", header_.table.pointSize(),
             " bytes, expected at most ", kMaxPcdPointSize);
  }

  void
  parseSizes()
  {
    constexpr std::size_t most = UINT32_MAX; // so that the product fits 64 bits
    PcdTable& table = header_.table;
    table.width = number("WIDTH", words("WIDTH", 1)[0], 0, most);
    table.height = number("HEIGHT", words("HEIGHT", 1)[0], 0, most);
    table.points = table.width * table.height;
    if (!has("POINTS"))
      return;
    const std::string_view points = words("POINTS", 1)[0];
    if (number("POINTS", points, 0, SIZE_MAX) != table.points)
      refuse("POINTS", " is ", inQuotes(points), ", expected WIDTH x HEIGHT, which is ",
             table.points);
  }

  void
  parseViewpoint()
  {
    std::array<double, 7>& viewpoint = header_.table.viewpoint;
    const Words& values = words("VIEWPOINT", viewpoint.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!parseWhole(values[i], viewpoint[i]) || !std::isfinite(viewpoint[i]))
        refuse("VIEWPOINT", ": ", inQuotes(values[i]), " is not a finite number");
  }

  const std::string& path_;
  std::string_view file_;
  std::map<std::string_view, HeaderLine> lines_;
  PcdHeader header_;
};

enum class Outcome { done, no_number, out_of_range };

// A number too small for its type is the type's zero, one too large is refused: the two
// are told apart in double.
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
  const PcdField* field;
  Outcome (*parse)(std::string_view, std::uint8_t*);
};

std::vector<Element>
elementsOf(const PcdTable& table)
{
  std::vector<Element> elements;
  for (const PcdField& field : table.fields)
    elements.insert(elements.end(), std::size_t(field.count),
                    {&field, withTypeOf(field, [](auto zero) {
                       return &parseElement<decltype(zero)>;
                     })});
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
      badInput(atLine(path, number), ": has ", i, " number(s), expected ",
               elements.size());
    std::uint8_t bytes[8];
    const Outcome outcome = elements[i].parse(word, bytes);
    if (outcome != Outcome::done)
      badInput(atLine(path, number), ": ", inQuotes(word),
               outcome == Outcome::no_number ? " is not" : " is too large for",
               " a number of field ", inQuotes(field.name), ", type ", field.type,
               " of ", field.size, " bytes");
    data.insert(data.end(), bytes, bytes + field.size);
  }
  if (!takeWord(rest).empty())
    badInput(atLine(path, number), ": has more than ", elements.size(), " numbers");
}

std::vector<std::uint8_t>
decodeAscii(const std::string& path, const PcdHeader& header, std::string_view file)
{
  // At least two characters an element: what a false number of points asks for is no
  // reason to allocate.
  const std::vector<Element> elements = elementsOf(header.table);
  const std::size_t possible =
      (file.size() - header.data_offset + 1) / (2 * elements.size());
  std::vector<std::uint8_t> data;
  data.reserve(std::min(header.table.points, possible) * header.table.pointSize());
  std::size_t offset = header.data_offset, points = 0;
  for (int number = header.data_line + 1; offset < file.size(); ++number) {
    const std::string_view line = takeLine(file, offset);
    if (line.find_first_not_of(" \t") == std::string_view::npos)
      continue;
    if (points++ == header.table.points)
      badInput(atLine(path, number), ": is beyond the ", header.table.points,
               " points of the header");
    parsePoint(line, elements, path, number, data);
  }
  if (points != header.table.points)
    badInput(path, ": has ", points, " points, expected ", header.table.points);
  return data;
}

// PCL fills the last page of a file; pages have up to 64 KiB.
void
checkBehindData(const std::string& path, std::string_view rest)
{
  constexpr std::size_t most = 65536;
  if (rest.size() > most || rest.find_first_not_of('\0') != std::string_view::npos)
    badInput(path, ": has ", rest.size(), " bytes behind the data of its points");
}

// Bytes of all points, which fit 64 bits: points < 2^64 and what the file has are
// compared before they are multiplied.
std::size_t
dataSize(const std::string& path, const PcdTable& table, std::size_t available)
{
  const std::size_t size = table.pointSize();
  if (table.points > available / size)
    badInput(path, ": holds ", available, " bytes of data, expected ", table.points,
             " points of ", size, " bytes");
  return table.points * size;
}

std::uint32_t
readUint32(std::string_view bytes)
{
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

// Unpacks LZF: a control byte c < 32 is followed by c + 1 bytes as they are; any other
// repeats earlier ones: length (c >> 5) + 2, where 7 + 2 is lengthened by the next
// byte, from (c & 31) * 256 + next byte + 1 bytes back. False unless `packed` is whole
// and gives exactly `size` bytes.
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
    for (std::size_t k = 0; k < length; ++k) // may read what it has just written
      result.push_back(result[result.size() - back]);
  }
  return result.size() == size;
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
    for (std::size_t i = 0; i < table.points; ++i, from += field.bytes())
      std::copy_n(from, field.bytes(), rows.data() + i * row + offset);
    offset += field.bytes();
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
  checkBehindData(path, data.substr(packed_size));
  const std::size_t expected = dataSize(path, table, packed_size * max_expansion);
  if (unpacked_size != expected)
    badInput(path, ": its compressed data are ", unpacked_size,
             " bytes long, expected ", expected, " for ", table.points, " points");
  std::vector<std::uint8_t> columns;
  if (!unpackLzf(data.substr(0, packed_size), expected, columns))
    badInput(path, ": its compressed data are damaged");
  return toRows(table, columns);
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

} // namespace

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

std::vector<std::uint8_t>
decodeData(const std::string& path, const PcdHeader& header, std::string_view file)
{
  if (header.encoding == PcdEncoding::ascii)
    return decodeAscii(path, header, file);
  const std::string_view data = file.substr(header.data_offset);
  if (header.encoding == PcdEncoding::binary_compressed)
    return decodeCompressed(path, header.table, data);
  const std::size_t size = dataSize(path, header.table, data.size());
  checkBehindData(path, data.substr(size));
  return {data.begin(), data.begin() + static_cast<std::ptrdiff_t>(size)};
}

PcdTable
decodePcd(const std::string& path, std::string_view file)
{
  PcdHeader header = HeaderParser(path, file).parse();
  header.table.data = decodeData(path, header, file);
  header.table.removeColumns(kPadding);
  if (header.table.fields.empty())
    badInput(path, ": has no field but padding");
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
  const auto line = [&](const char* name, auto member) {
    stream << name;
    for (const PcdField& field : table.fields)
      stream << ' ' << field.*member;
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
  line("FIELDS", &PcdField::name);
  line("SIZE", &PcdField::size);
  line("TYPE", &PcdField::type);
  line("COUNT", &PcdField::count);
  const bool is_list = table.width == 0 && table.height == 0;
  stream << "WIDTH " << (is_list ? table.points : table.width) << "\nHEIGHT "
         << (is_list ? 1 : table.height) << "\nVIEWPOINT";
  stream.precision(17);
  for (const double value : table.viewpoint)
    stream << ' ' << value;
  stream << "\nPOINTS " << table.points << "\nDATA binary\n";
}

void
writeCloudTable(const std::string& path, const PcdTable& table)
{
  checkTable(path, table);
  AtomicFile file(path);
  writePcdHeader(file.stream(), table);
  file.stream().write(reinterpret_cast<const char*>(table.data.data()),
                      std::streamsize(table.data.size()));
  file.commit();
}

} // namespace pcl_semantic
