// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_file.h"
#include "core/fail.h"
#include "pcd_data.h"
#include "pcd_header.h"
#include "pcd_table.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace pcl_semantic {

PcdTable
decodePcd(const std::string& path, std::string_view file)
{
  PcdHeader header = parsePcdHeader(path, file);
  header.table.data = decodeData(path, header, file);
  header.table.removeColumns(kPadding);
  if (header.table.fields.empty())
    badInput(path, ": has no field but padding");
  return std::move(header.table);
}

PcdTable
readPcd(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  return decodePcd(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void
writeCloudTable(const std::string& path, const PcdTable& table)
{
  checkTable(path, table);
  AtomicFile file(path);
  writePcdHeader(file.stream(), table);
  file.stream().write(reinterpret_cast<const char*>(table.data.data()),
                      std::streamsize(table.data.size()));
  file.commit();
}

} // namespace pcl_semantic
