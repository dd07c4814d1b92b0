// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_header.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

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
  place(const char* keyword) const
  {
    return placeOf(path_, line(keyword).number) + ": " + keyword;
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
      if (keyword.empty() || keyword[0] == '#')
        continue;
      if (!known.count(keyword))
        PCL_THROW_EXCEPTION(BadInputException,
                            placeOf(path_, number)
                                << ": " << inQuotes(keyword)
                                << " is no keyword of a .pcd header");
      const auto [entry, is_new] = lines_.try_emplace(keyword);
      if (!is_new)
        PCL_THROW_EXCEPTION(BadInputException, placeOf(path_, number)
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

  const Words&
  words(const char* keyword, std::size_t count) const
  {
    const Words& found = line(keyword).words;
    if (found.size() != count)
      PCL_THROW_EXCEPTION(BadInputException, place(keyword)
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
      PCL_THROW_EXCEPTION(BadInputException, place(keyword)
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
    PCL_THROW_EXCEPTION(BadInputException, place(keyword) << " is " << inQuotes(word)
                                                          << ", expected " << expected);
  }

  void
  parseFields()
  {
    const Words& names = line("FIELDS").words;
    if (names.empty())
      PCL_THROW_EXCEPTION(BadInputException, place("FIELDS") << " names none");
    const Words& sizes = words("SIZE", names.size());
    const Words& types = words("TYPE", names.size());
    const Words counts =
        has("COUNT") ? words("COUNT", names.size()) : Words(names.size(), "1");
    std::set<std::string_view> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] != "_" && !seen.insert(names[i]).second)
        PCL_THROW_EXCEPTION(BadInputException, place("FIELDS")
                                                   << " names " << inQuotes(names[i])
                                                   << " for the second time");
      PcdField field;
      field.name = std::string(names[i]);
      field.size = static_cast<int>(number("SIZE", sizes[i], 1, 8));
      field.count = static_cast<int>(number("COUNT", counts[i], 1, kMaxPcdCount));
      field.type = types[i].size() == 1 ? types[i][0] : '?';
      if (!field.isValid()) // sizes and counts are checked, and words have no blank
        PCL_THROW_EXCEPTION(BadInputException,
                            place("TYPE")
                                << ": field " << inQuotes(names[i]) << " is "
                                << inQuotes(types[i]) << " of " << field.size
                                << " bytes, expected a name, F (4 or 8), I or U (1, "
                                   "2, 4 or 8) or B (1)");
      header_.table.fields.push_back(field);
    }
    if (header_.table.pointSize() > kMaxPcdPointSize)
      PCL_THROW_EXCEPTION(BadInputException,
                          place("FIELDS")
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
                          place("POINTS") << " is " << inQuotes(words("POINTS", 1)[0])
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
        PCL_THROW_EXCEPTION(BadInputException, place("VIEWPOINT")
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

} // namespace pcl_semantic
