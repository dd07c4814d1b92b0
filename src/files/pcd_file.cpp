// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_file.h"
#include "clouds/table_parts.h"
#include "core/fail.h"
#include "pcd_data.h"
#include "pcd_header.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

// Writes the fields in their order, without the gaps between them.
void
writeRows(std::ostream& stream, const PcdTable& table)
{
  std::vector<std::pair<std::size_t, std::size_t>> runs; // offset and size
  for (const pcl::PCLPointField& field : table.fields)
    if (!runs.empty() && runs.back().first + runs.back().second == field.offset)
      runs.back().second += sizeOfField(field);
    else
      runs.emplace_back(field.offset, sizeOfField(field));
  const auto* const first = reinterpret_cast<const char*>(table.data.data());
  if (runs.size() == 1 && runs[0].second == table.point_step)
    stream.write(first, std::streamsize(table.data.size()));
  else
    for (std::size_t i = 0; i < table.points(); ++i)
      for (const auto& [offset, size] : runs)
        stream.write(first + i * table.point_step + offset, std::streamsize(size));
}

} // namespace

PcdTable
readPcd(const std::string& path)
{
  std::vector<std::uint8_t> bytes = readBytes(path);
  PcdHeader header = parsePcdHeader(path, textOf(bytes));
  header.table.data = decodeData(path, header, std::move(bytes));
  header.table.removeColumns(kPadding);
  return std::move(header.table);
}

void
writeCloudTable(const std::string& path, const PcdTable& table)
{
  checkTable(path, table);
  AtomicFile file(path);
  writePcdHeader(file.stream(), table);
  writeRows(file.stream(), table);
  file.commit();
}

} // namespace pcl_semantic
