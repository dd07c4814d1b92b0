// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"

#include <pcl_semantic/files/cloud_file.h>

#include <cstring>

namespace pcl_semantic::python {

namespace {

// As numpy calls it: 'f4', 'u1'.
std::string
kindOf(const PcdField& field)
{
  const char kind = field.type == 'F' ? 'f' : field.type == 'I' ? 'i' : 'u';
  return kind + std::to_string(field.size);
}

// Of a text, a number or a list of names; None = as the name of the file says.
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

py::dict
readCloud(const Path& path, const py::object& scan_columns)
{
  const ScanColumns columns = columnsOf(scan_columns);
  const PcdTable table = released([&] { return readCloudTable(path, columns); });
  for (const std::string& doubt : table.doubts)
    warn(doubt);
  const std::size_t stride = table.pointSize();
  const std::uint8_t* from = table.data.data();
  py::dict cloud;
  for (const PcdField& field : table.fields) {
    std::vector<py::ssize_t> shape{py::ssize_t(table.points)};
    if (field.count > 1)
      shape.push_back(field.count);
    py::array column(py::dtype(kindOf(field)), shape);
    const std::size_t bytes = field.bytes();
    auto* to = static_cast<std::uint8_t*>(column.mutable_data());
    for (std::size_t i = 0; i < table.points; ++i, to += bytes)
      std::memcpy(to, from + i * stride, bytes);
    cloud[py::str(field.name)] = column;
    from += bytes;
  }
  return cloud;
}

PcdField
fieldOf(const std::string& name, const py::array& column)
{
  const char kind = column.dtype().kind();
  const PcdField field{name,
                       kind == 'f'   ? 'F'
                       : kind == 'i' ? 'I'
                                     : 'U',
                       int(column.itemsize()),
                       column.ndim() == 2 ? int(column.shape(1)) : 1};
  if (std::strchr("fiu", kind) == nullptr || column.ndim() < 1 || column.ndim() > 2 ||
      !field.isValid())
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
  bool is_first = true;
  for (const auto& [key, value] : cloud) {
    const auto name = key.cast<std::string>();
    requireNumbers(value);
    auto column = py::array::ensure(value, py::array::c_style);
    if (!column)
      throw py::error_already_set();
    if (column.dtype().byteorder() == '>') // as plyfile has them of a big-endian .ply
      column = column.attr("astype")(column.dtype().attr("newbyteorder")("<"));
    const PcdField field = fieldOf(name, column);
    if (is_first)
      table.points = std::size_t(column.shape(0));
    requireShape(column, name.c_str(), py::ssize_t(table.points),
                 column.ndim() == 2 ? std::optional(column.shape(1)) : std::nullopt);
    const auto* const bytes = static_cast<const std::uint8_t*>(column.data());
    table.setColumn(field, {bytes, bytes + table.points * field.bytes()});
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
      "and probability, too; instances are taken off label. scan_columns: of a .bin,\n"
      "'x,y,z,intensity,ring' or their number. Warns of fields that look like these\n"
      "and are not read.");
  module.def("write_cloud", &writeCloud, py::arg("path"), py::arg("cloud"),
             "Writes fields as a binary .pcd, whole or not at all.");
}

} // namespace pcl_semantic::python
