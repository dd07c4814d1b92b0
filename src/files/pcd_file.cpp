/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/pcd_file.h>

#include <functional>

namespace pcl_semantic {

std::size_t
PcdTable::pointSize() const
{
  std::size_t size = 0;
  for (const PcdField& field : fields)
    size +=
        static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.count);
  return size;
}

void
writePcd(const std::string& path, const PcdTable& table)
{
  if (table.fields.empty() || table.data.size() != table.points * table.pointSize())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        path << ": " << table.data.size()
                             << " bytes of data do not fit the fields of "
                             << table.points << " points");
  AtomicFile file(path);
  std::ostream& stream = file.stream();
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
  stream << "WIDTH " << table.points << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
         << table.points << "\nDATA binary\n";
  stream.write(reinterpret_cast<const char*>(table.data.data()),
               std::streamsize(table.data.size()));
  file.commit();
}

} // namespace pcl_semantic
