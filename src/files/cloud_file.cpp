// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/cloud_file.h>

#include "other_formats.h"
#include "pcd_file.h"
#include "ply_reader.h"
#include "scan_file.h"

#include "clouds/known_fields.h"
#include "clouds/table_parts.h"
#include "core/fail.h"

#include <boost/algorithm/string/case_conv.hpp>

#include <filesystem>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

PcdTable
readFields(const std::string& path, const ScanColumns& columns)
{
  const std::string extension =
      boost::algorithm::to_lower_copy(fs::path(path).extension().string());
  refuseOtherFormats(path);
  if (!columns.empty() && extension != ".bin")
    badParameter(path, ": scan columns are for .bin, which has no header");
  PcdTable table = extension == ".ply"   ? readPly(path)
                   : extension == ".bin" ? readScan(path, columns)
                                         : readPcd(path);
  table.row_step = table.width * table.point_step;
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
readCloudTable(const std::string& path, const ScanColumns& columns)
{
  PcdTable table = readFields(path, columns);
  addKnownFields(path, table);
  return table;
}

LabelledCloud
readLabelledCloud(const std::string& path, const LabelMapping* mapping,
                  const ScanColumns& columns)
{
  return labelledCloudOf(readFields(path, columns), path, mapping);
}

void
writeLabelledCloud(const std::string& path, const LabelledCloud& labelled)
{
  writeCloudTable(path, tableOf(labelled, path));
}

void
writeCliques(const std::string& path, const LabelledCloud& labelled)
{
  PcdTable table = labelled.table;
  if (table.points() != labelled.cloud->size())
    badParameter(path, ": the cloud has ", labelled.cloud->size(),
                 " points, its table ", table.points());
  setCliqueColumn(path, labelled.cliques, table);
  writeCloudTable(path, table);
}

} // namespace pcl_semantic
