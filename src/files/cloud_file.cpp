// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_data.h"
#include "pcd_file.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/input_file.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

struct PlyType {
  const char *name, *other_name;
  char type;
  int size;
};

constexpr PlyType kPlyTypes[] = {
    {"char", "int8", 'I', 1},     {"uchar", "uint8", 'U', 1},
    {"short", "int16", 'I', 2},   {"ushort", "uint16", 'U', 2},
    {"int", "int32", 'I', 4},     {"uint", "uint32", 'U', 4},
    {"float", "float32", 'F', 4}, {"double", "float64", 'F', 8}};

class PlyHeaderParser {
public:
  PlyHeaderParser(const std::string& path, std::string_view file)
      : path_(path), file_(file)
  {}

  PcdHeader
  parse()
  {
    if (takeLine(file_, header_.data_offset) != "ply")
      PCL_THROW_EXCEPTION(BadInputException, path_ << ": does not begin with 'ply'");
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
      else if (keyword == "property" && in_vertex_)
        parseProperty(line);
    }
    PCL_THROW_EXCEPTION(BadInputException, path_ << ": has no end_header");
  }

private:
  [[noreturn]] void
  fail(const std::string& what) const
  {
    PCL_THROW_EXCEPTION(BadInputException, atLine(path_, header_.data_line)
                                               << ": " << what);
  }

  void
  parseFormat(std::string_view line)
  {
    const std::string_view format = takeWord(line);
    if (format != "ascii" && format != "binary_little_endian")
      fail("format is " + inQuotes(format) +
           ", expected ascii or binary_little_endian");
    header_.encoding = format == "ascii" ? PcdEncoding::ascii : PcdEncoding::binary;
    has_format_ = true;
  }

  void
  parseElement(std::string_view line)
  {
    in_vertex_ = takeWord(line) == "vertex";
    if (!in_vertex_ && !has_vertices_)
      fail("vertices have to be the first element");
    if (!in_vertex_)
      return;
    const double count =
        parseNumber(std::string(takeWord(line)), atLine(path_, header_.data_line));
    if (has_vertices_ || !(count >= 0.0 && count <= double(1u << 31)) ||
        count != double(std::size_t(count)))
      fail("expected one element vertex and its number");
    header_.table.points = std::size_t(count);
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
        header_.table.fields.push_back({name, each.type, each.size});
        if (!header_.table.fields.back().isValid() || !names_.insert(name).second)
          fail("property " + inQuotes(name) + " has no name, or one that is taken");
        return;
      }
    fail("property of type " + inQuotes(type) + ", expected a scalar one of vertices");
  }

  PcdHeader
  checked() const
  {
    if (!has_format_ || header_.table.fields.empty())
      PCL_THROW_EXCEPTION(BadInputException,
                          path_ << ": has no format, or no vertices with properties");
    return header_;
  }

  const std::string& path_;
  std::string_view file_;
  PcdHeader header_;
  std::set<std::string> names_;
  bool has_format_ = false, has_vertices_ = false, in_vertex_ = false;
};

// The file without what follows the vertices: faces, mostly.
std::string_view
withoutOtherElements(const PcdHeader& header, std::string_view file)
{
  if (header.encoding == PcdEncoding::ascii) {
    std::size_t end = header.data_offset;
    for (std::size_t i = 0; i < header.table.points && end < file.size(); ++i)
      takeLine(file, end);
    return file.substr(0, end);
  }
  const std::size_t available = file.size() - header.data_offset;
  const std::size_t size = header.table.pointSize();
  return header.table.points > available / size
             ? file
             : file.substr(0, header.data_offset + header.table.points * size);
}

// Red, green and blue of their own into PCL's packed colour.
void
packColours(PcdTable& table)
{
  const int red = table.find("red"), green = table.find("green"),
            blue = table.find("blue");
  if (red < 0 || green < 0 || blue < 0)
    return;
  for (const int field : {red, green, blue})
    if (table.fields[std::size_t(field)].type != 'U' ||
        table.fields[std::size_t(field)].size != 1)
      return; // they mean something else
  const PcdColumn r(table, red), g(table, green), b(table, blue);
  std::vector<std::uint8_t> bytes(4 * table.points, 255);
  for (std::size_t i = 0; i < table.points; ++i) {
    bytes[4 * i] = std::uint8_t(b(i)); // little-endian
    bytes[4 * i + 1] = std::uint8_t(g(i));
    bytes[4 * i + 2] = std::uint8_t(r(i));
  }
  for (const char* const name : {"red", "green", "blue", "alpha"})
    table.removeColumns(name);
  table.setColumn({"rgba", 'U'}, bytes);
}

PcdTable
readPly(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  const std::string_view file(reinterpret_cast<const char*>(bytes.data()),
                              bytes.size());
  PcdHeader header = PlyHeaderParser(path, file).parse();
  const std::string_view vertices = withoutOtherElements(header, file);
  header.table.data = header.encoding == PcdEncoding::ascii
                          ? decodePcdAscii(path, header, vertices)
                          : decodePcdBinary(path, header, vertices);
  packColours(header.table);
  header.table.width = header.table.points;
  header.table.height = 1;
  return std::move(header.table);
}

// The labels that belong to a scan; empty if there are none.
std::string
labelsOfScan(const fs::path& scan)
{
  const fs::path name = scan.stem().string() + ".label";
  for (const fs::path& file :
       {scan.parent_path() / name, scan.parent_path() / ".." / "labels" / name})
    if (fs::exists(file))
      return file.string();
  return {};
}

PcdTable
readScan(const std::string& path)
{
  PcdTable table;
  table.data = readBytes(path);
  table.fields = {{"x"}, {"y"}, {"z"}, {"intensity"}};
  table.points = table.data.size() / table.pointSize();
  table.width = table.points;
  table.height = 1;
  if (table.points == 0 || table.data.size() % table.pointSize() != 0)
    PCL_THROW_EXCEPTION(
        BadInputException,
        path << ": has " << table.data.size()
             << " bytes, expected a multiple of 16 (4 float32 a point)");
  const std::string labels = labelsOfScan(path);
  if (labels.empty())
    return table;
  std::vector<std::uint8_t> bytes = readBytes(labels);
  if (bytes.size() != 4 * table.points)
    PCL_THROW_EXCEPTION(BadInputException,
                        labels << ": has " << bytes.size() << " bytes, expected "
                               << 4 * table.points << ": uint32 for each point of "
                               << path);
  for (std::size_t i = 0; i < table.points; ++i)
    bytes[4 * i + 2] = bytes[4 * i + 3] = 0; // the instance
  table.setColumn({"label", 'U'}, bytes);
  return table;
}

} // namespace

const std::vector<std::string>&
cloudExtensions()
{
  static const std::vector<std::string> extensions{".pcd", ".ply", ".bin"};
  return extensions;
}

PcdTable
readCloudTable(const std::string& path)
{
  const std::string extension =
      boost::algorithm::to_lower_copy(fs::path(path).extension().string());
  if (extension == ".ply")
    return readPly(path);
  return extension == ".bin" ? readScan(path) : readPcd(path);
}

void
writeCloudTable(const std::string& path, const PcdTable& table)
{
  writePcd(path, table);
}

} // namespace pcl_semantic
