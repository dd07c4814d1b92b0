// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_header.h"
#include "clouds/table_parts.h"
#include "core/fail.h"
#include "core/parse_whole.h"

#include <pcl_semantic/files/input_file.h>

#include <pcl/common/io.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <ostream>
#include <set>
#include <vector>

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
      badInput(path_, ": the header has no ", keyword);
    return entry->second;
  }

  template <typename... Parts>
  [[noreturn]] void
  refuse(const char* keyword, const Parts&... parts) const
  {
    badInput(atLine(path_, line(keyword).number), ": ", keyword, parts...);
  }

  // Collects the lines up to DATA by their first words.
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

  // Comments of other programs may begin the same way, so invalid ones are ignored.
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
    PcdTable& table = header_.table;
    std::set<std::string_view> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == kPadding && counts[i] == "0")
        continue; // PCL writes padding of zero bytes between adjacent fields
      if (names[i] != kPadding && !seen.insert(names[i]).second)
        refuse("FIELDS", " names ", inQuotes(names[i]), " for the second time");
      const int size = int(number("SIZE", sizes[i], 1, 8));
      const std::size_t count = number("COUNT", counts[i], 1, kMaxPcdCount);
      const int datatype = pcl::getFieldType(size, types[i][0]);
      // Sizes and counts are already checked, and words contain no blank.
      if (types[i] != std::string(1, pcl::getFieldType(datatype)) ||
          !isPcdField({std::string(names[i]), 0, std::uint8_t(datatype), 1}))
        refuse("TYPE", ": field ", inQuotes(names[i]), " is ", inQuotes(types[i]),
               " of ", size,
               " bytes, expected a name, F (4 or 8), I or U (1, 2, 4 or 8) or B (1)");
      if (const auto step = table.point_step + std::size_t(size) * count;
          step > kMaxPcdPointSize)
        refuse("FIELDS", " make points of ", step, " bytes, expected at most ",
               kMaxPcdPointSize);
      table.addField(std::string(names[i]), std::uint8_t(datatype), count);
    }
    if (seen.empty())
      badInput(path_, ": has no field but padding");
  }

  void
  parseSizes()
  {
    constexpr std::size_t most = UINT32_MAX; // so that the product fits 64 bits
    PcdTable& table = header_.table;
    table.width = pcl::uindex_t(number("WIDTH", words("WIDTH", 1)[0], 0, most));
    table.height = pcl::uindex_t(number("HEIGHT", words("HEIGHT", 1)[0], 0, most));
    if (!has("POINTS"))
      return;
    const std::string_view points = words("POINTS", 1)[0];
    if (number("POINTS", points, 0, SIZE_MAX) != table.points())
      refuse("POINTS", " is ", inQuotes(points), ", expected WIDTH x HEIGHT, which is ",
             table.points());
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

} // namespace

PcdHeader
parsePcdHeader(const std::string& path, std::string_view file)
{
  return HeaderParser(path, file).parse();
}

void
writePcdHeader(std::ostream& stream, const PcdTable& table)
{
  const auto line = [&](const char* name, auto valueOf) {
    stream << name;
    for (const pcl::PCLPointField& field : table.fields)
      stream << ' ' << valueOf(field);
    stream << '\n';
  };
  stream << "# .PCD v0.7 - Point Cloud Data file format\n";
  if (table.voxel_grid[0] > 0.0) {
    stream.precision(15); // 0.1 is written as 0.1
    stream << "# voxel_grid";
    for (const double value : table.voxel_grid)
      stream << ' ' << value;
    stream << '\n';
  }
  stream << "VERSION 0.7\n";
  line("FIELDS", [](const auto& field) { return field.name; });
  line("SIZE", [](const auto& field) { return pcl::getFieldSize(field.datatype); });
  line("TYPE", [](const auto& field) { return pcl::getFieldType(field.datatype); });
  line("COUNT", [](const auto& field) { return field.count; });
  const bool is_nothing = table.width == 0 && table.height == 0;
  stream << "WIDTH " << table.width << "\nHEIGHT " << (is_nothing ? 1 : table.height)
         << "\nVIEWPOINT";
  stream.precision(17);
  for (const double value : table.viewpoint)
    stream << ' ' << value;
  stream << "\nPOINTS " << table.points() << "\nDATA binary\n";
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

} // namespace pcl_semantic
