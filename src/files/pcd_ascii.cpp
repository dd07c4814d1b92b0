// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_data.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace pcl_semantic {

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
      PCL_THROW_EXCEPTION(BadInputException, placeOf(path, number)
                                                 << ": has " << i
                                                 << " number(s), expected "
                                                 << elements.size());
    std::uint8_t bytes[8];
    const Outcome outcome = elements[i].parse(word, bytes);
    if (outcome != Outcome::done)
      PCL_THROW_EXCEPTION(
          BadInputException,
          placeOf(path, number)
              << ": " << inQuotes(word)
              << (outcome == Outcome::no_number ? " is not" : " is too large for")
              << " a number of field " << inQuotes(field.name) << ", type "
              << field.type << " of " << field.size << " bytes");
    data.insert(data.end(), bytes, bytes + field.size);
  }
  if (!takeWord(rest).empty())
    PCL_THROW_EXCEPTION(BadInputException, placeOf(path, number)
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
      PCL_THROW_EXCEPTION(BadInputException, placeOf(path, number)
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

} // namespace pcl_semantic
