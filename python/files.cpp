// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"
#include "core/text_stream.h"

#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/files/cloud_file.h>

#include <pcl/common/io.h>

#include <cstring>

namespace pcl_semantic::python {

namespace {

// Type in numpy's notation: 'f4', 'u1'.
std::string
kindOf(const pcl::PCLPointField& field)
{
  const char type = pcl::getFieldType(field.datatype);
  const char kind = type == 'F' ? 'f' : type == 'I' ? 'i' : 'u';
  return kind + std::to_string(pcl::getFieldSize(field.datatype));
}

// Parses a text, a number or a list of names; None = from the file's name.
ScanColumns
columnsOf(const py::object& columns)
{
  if (columns.is_none())
    return {};
  std::string text;
  if (py::isinstance<py::sequence>(columns) && !py::isinstance<py::str>(columns))
    for (const py::handle each : columns)
      text += (text.empty() ? "" : ",") + py::str(each).cast<std::string>();
  else
    text = py::str(columns).cast<std::string>();
  return parseScanColumns(text);
}

// Positions of a map are relative to an origin in the header's comment. Arrays contain
// world positions in double precision.
void
addOriginOfMap(const PcdTable& table, py::dict& cloud)
{
  const auto& [size, x, y, z] = table.voxel_grid;
  if (!(size > 0.0) || (x == 0.0 && y == 0.0 && z == 0.0))
    return;
  const std::pair<const char*, double> corner[] = {{"x", x}, {"y", y}, {"z", z}};
  for (const auto& [name, offset] : corner)
    if (cloud.contains(name))
      cloud[name] = cloud[name].attr("astype")("f8") - py::float_(offset);
}

// Warns of data that is missing or inexact in the arrays.
void
warnOfPositions(const std::string& path, const PcdTable& table)
{
  if (table.viewpoint != PcdTable().viewpoint) {
    TextStream text;
    text << path << ": its VIEWPOINT,";
    for (const double value : table.viewpoint)
      text << " " << value;
    text << ", is not read: positions stay in the frame of the file";
    warn(text.str());
  }
  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  cloud.resize(table.points());
  for (int axis = 0; axis < 3; ++axis) {
    const int field = table.find(std::string(1, char('x' + axis)));
    if (field < 0 ||
        table.fields[std::size_t(field)].datatype != pcl::PCLPointField::FLOAT32)
      return;
    const PcdColumn column(table, field);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud[i].data[axis] = float(column(i));
  }
  if (const std::string doubt = doubtOfSteps(cloud, path); !doubt.empty())
    warn(doubt);
}

py::dict
readCloud(const Path& path, const py::object& scan_columns)
{
  const ScanColumns columns = columnsOf(scan_columns);
  const PcdTable table = released([&] { return readCloudTable(path, columns); });
  for (const std::string& doubt : table.doubts)
    warn(doubt);
  warnOfPositions(path, table);
  const auto points = py::ssize_t(table.points());
  py::dict cloud;
  for (const pcl::PCLPointField& field : table.fields) {
    std::vector<py::ssize_t> shape{points};
    if (field.count > 1)
      shape.push_back(field.count);
    py::array column(py::dtype(kindOf(field)), shape);
    const std::size_t bytes = sizeOfField(field);
    auto* to = static_cast<std::uint8_t*>(column.mutable_data());
    const std::uint8_t* from = table.data.data() + field.offset;
    for (py::ssize_t i = 0; i < points; ++i, to += bytes, from += table.point_step)
      std::memcpy(to, from, bytes);
    cloud[py::str(field.name)] = column;
  }
  if (!table.instances.empty() && !cloud.contains("instance"))
    cloud["instance"] = py::array_t<std::uint16_t>(py::ssize_t(table.instances.size()),
                                                   table.instances.data());
  addOriginOfMap(table, cloud);
  return cloud;
}

pcl::PCLPointField
fieldOf(const std::string& name, const py::array& column)
{
  if (name.empty() || name == "_" || name.find_first_of(" \t\r\n") != name.npos)
    badParameter("'", name,
                 "' cannot be the name of a field: expected a word, not _, which is "
                 "padding");
  const char kind = column.dtype().kind();
  const int datatype = pcl::getFieldType(int(column.itemsize()), kind);
  const pcl::PCLPointField field{
      name, 0, std::uint8_t(datatype),
      pcl::uindex_t(column.ndim() == 2 ? column.shape(1) : 1)};
  if (std::strchr("fiu", kind) == nullptr || column.ndim() < 1 || column.ndim() > 2 ||
      !isPcdField(field))
    badParameter("'", name,
                 "' cannot be a field: expected N, or N x COUNT, floats of 4 or 8 "
                 "bytes or integers of 1 to 8");
  return field;
}

void
writeCloud(const Path& path, const py::dict& cloud)
{
  requirePcdName(path);
  PcdTable table;
  table.height = 1;
  bool is_first = true;
  for (const auto& [key, value] : cloud) {
    if (!py::isinstance<py::str>(key))
      throw py::type_error("the name of a field is " +
                           py::repr(key).cast<std::string>() + ", expected a str");
    const auto name = key.cast<std::string>();
    auto column = py::array::ensure(numbersOf(value), py::array::c_style);
    if (!column)
      throw py::error_already_set();
    if (column.dtype().byteorder() == '>') // from plyfile, for a big-endian .ply
      column = column.attr("astype")(column.dtype().attr("newbyteorder")("<"));
    const pcl::PCLPointField field = fieldOf(name, column);
    if (is_first)
      table.width = pcl::uindex_t(column.shape(0));
    requireShape(column, name.c_str(), py::ssize_t(table.width),
                 column.ndim() == 2 ? std::optional(column.shape(1)) : std::nullopt);
    table.setColumn(field, column.data(), std::size_t(column.nbytes()));
    is_first = false;
  }
  released([&] { writeCloudTable(path, table); });
}

} // namespace

void
bindFiles(py::module_& module)
{
  module.def(
      "read_cloud", &readCloud, py::arg("path"), py::kw_only(),
      py::arg("scan_columns") = py::none(),
      "The fields of a .pcd, .ply or .bin file: arrays of N, or N x COUNT, by name.\n"
      "Labels, colours and probabilities under other names are there as label, rgba\n"
      "and probability, too; instances are taken off label, and are there as "
      "instance.\n"
      "Positions of a map are in the world, doubles if it is far away. scan_columns: "
      "of a "
      ".bin,\n"
      "'x,y,z,intensity,ring' or their number. Warns of fields that look like these\n"
      "and are not read.");
  module.def("write_cloud", &writeCloud, py::arg("path"), py::arg("cloud"),
             "Writes fields as a binary .pcd, whole or not at all.");
}

} // namespace pcl_semantic::python
