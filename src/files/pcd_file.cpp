// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_data.h"
#include "pcd_header.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/pcd_file.h>

#include <cmath>
#include <functional>
#include <set>

namespace pcl_semantic {

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
  stream << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n";
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
