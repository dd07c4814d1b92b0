// SPDX-License-Identifier: BSD-3-Clause
#include "ply_reader.h"
#include "clouds/known_fields.h"
#include "pcd_data.h"
#include "pcd_header.h"

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <set>

namespace pcl_semantic {

namespace {

struct PlyType {
  const char *name, *other_name;
  std::uint8_t datatype;
};

using Field = pcl::PCLPointField;

constexpr PlyType kPlyTypes[] = {
    {"char", "int8", Field::INT8},        {"uchar", "uint8", Field::UINT8},
    {"short", "int16", Field::INT16},     {"ushort", "uint16", Field::UINT16},
    {"int", "int32", Field::INT32},       {"uint", "uint32", Field::UINT32},
    {"float", "float32", Field::FLOAT32}, {"double", "float64", Field::FLOAT64}};

class PlyHeaderParser {
public:
  PlyHeaderParser(const std::string& path, std::string_view file)
      : path_(path), file_(file)
  {}

  PcdHeader
  parse()
  {
    if (takeLine(file_, header_.data_offset) != "ply")
      badInput(path_, ": does not begin with 'ply'");
    header_.data_line = 1;
    while (header_.data_offset < file_.size()) {
      std::string_view line = takeLine(file_, header_.data_offset);
      ++header_.data_line;
      const std::string_view keyword = takeWord(line);
      if (keyword == "end_header")
        return checked();
      if (keyword == "format")
        parseFormat(line);
      else if (keyword == "element")
        parseElement(line);
      else if (keyword == "comment")
        parseComment(line);
      else if (keyword == "property" && in_vertex_)
        parseProperty(line);
    }
    badInput(path_, ": has no end_header");
  }

private:
  template <typename... Parts>
  [[noreturn]] void
  refuse(const Parts&... parts) const
  {
    badInput(atLine(path_, header_.data_line), ": ", parts...);
  }

  void
  parseFormat(std::string_view line)
  {
    const std::string_view format = takeWord(line);
    if (format != "ascii" && format != "binary_little_endian")
      refuse("format is ", inQuotes(format),
             ", expected ascii or binary_little_endian");
    header_.encoding = format == "ascii" ? PcdEncoding::ascii : PcdEncoding::binary;
    has_format_ = true;
  }

  // Files of this library contain their origin, see writePly().
  void
  parseComment(std::string_view line)
  {
    if (takeWord(line) == "origin" && line.find_first_of("123456789") < line.size())
      addDoubt(header_.table, path_ +
                                  ": its points are relative to an origin (comment "
                                  "'origin" +
                                  std::string(line) + "'), which is not added");
  }

  void
  parseElement(std::string_view line)
  {
    in_vertex_ = takeWord(line) == "vertex";
    if (!in_vertex_ && !has_vertices_)
      refuse("vertices have to be the first element");
    if (!in_vertex_)
      return;
    const double count =
        parseNumber(std::string(takeWord(line)), atLine(path_, header_.data_line));
    if (has_vertices_ || !(count >= 0.0 && count <= double(1u << 31)) ||
        count != double(std::size_t(count)))
      refuse("expected one element vertex and its number");
    header_.table.width = pcl::uindex_t(count);
    header_.table.height = 1;
    has_vertices_ = true;
  }

  void
  parseProperty(std::string_view line)
  {
    const std::string_view type = takeWord(line);
    std::string name = boost::algorithm::to_lower_copy(std::string(takeWord(line)));
    if (name == "scalar_label")
      name = "label";
    for (const PlyType& each : kPlyTypes)
      if (type == each.name || type == each.other_name) {
        if (!isPcdField({name, 0, each.datatype, 1}) || !names_.insert(name).second)
          refuse("property ", inQuotes(name), " has an empty or repeated name");
        if (names_.size() > kMaxPcdPointSize / sizeof(double))
          refuse("too many properties");
        header_.table.addField(name, each.datatype);
        return;
      }
    refuse("property of type ", inQuotes(type), ", expected a scalar type");
  }

  PcdHeader
  checked() const
  {
    if (!has_format_ || header_.table.fields.empty())
      badInput(path_, ": has no format, or no vertices with properties");
    return header_;
  }

  const std::string& path_;
  std::string_view file_;
  PcdHeader header_;
  std::set<std::string> names_;
  bool has_format_ = false, has_vertices_ = false, in_vertex_ = false;
};

// Offset of the data after the vertices, usually faces.
std::size_t
endOfVertices(const PcdHeader& header, std::string_view file)
{
  const std::size_t points = header.table.points(), size = header.table.point_step;
  std::size_t end = header.data_offset;
  if (header.encoding == PcdEncoding::binary)
    return points > (file.size() - end) / size ? file.size() : end + points * size;
  for (std::size_t i = 0; i < points && end < file.size(); ++i)
    takeLine(file, end);
  return end;
}

// Packs separate fields for red, green and blue into PCL's colour.
void
packColours(PcdTable& table)
{
  std::vector<std::uint32_t> colours(table.points(), 0xFF);
  for (const char* const name : {"red", "green", "blue"}) {
    const int field = table.find(name);
    if (field < 0)
      return;
    const PcdColumn column(table, field);
    if (column.field().datatype != Field::UINT8)
      return; // it has another meaning
    for (std::size_t i = 0; i < colours.size(); ++i)
      colours[i] = colours[i] << 8 | std::uint32_t(column(i));
  }
  for (const char* const name : {"red", "green", "blue", "alpha"})
    table.removeColumns(name);
  table.setColumn("rgba", colours);
}

} // namespace

PcdTable
readPly(const std::string& path)
{
  std::vector<std::uint8_t> bytes = readBytes(path);
  PcdHeader header = PlyHeaderParser(path, textOf(bytes)).parse();
  bytes.resize(endOfVertices(header, textOf(bytes)));
  bytes.shrink_to_fit();
  header.table.data = decodeData(path, header, std::move(bytes));
  packColours(header.table);
  return std::move(header.table);
}

} // namespace pcl_semantic
