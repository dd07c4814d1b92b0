// SPDX-License-Identifier: BSD-3-Clause
#include "scan_file.h"
#include "clouds/known_fields.h"
#include "clouds/table_parts.h"
#include "core/parse_whole.h"
#include "is_there.h"
#include "scan_layout.h"

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/input_file.h>

#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

const ScanColumns kitti_columns = {"x", "y", "z", "intensity"};
const ScanColumns nuscenes_columns = {"x", "y", "z", "intensity", "ring"};

bool
isOfNuScenes(const fs::path& scan)
{
  return scan.stem().extension() == ".pcd";
}

// The working folder under the name by which it was entered, which may be a link.
fs::path
workingFolder()
{
  std::error_code error;
  const char* const named = std::getenv("PWD");
  if (named && fs::path(named).is_absolute() && fs::equivalent(named, ".", error))
    return named;
  return fs::current_path(error);
}

// The parent of a scan's folder, from the path as written, because a symbolic link may
// lead elsewhere.
fs::path
folderAbove(const fs::path& scan)
{
  const auto normal = [](const fs::path& path) {
    const fs::path result = path.lexically_normal();
    return result.has_filename() ? result : result.parent_path();
  };
  fs::path folder = normal(scan.parent_path());
  if (folder.empty() || folder == "." || folder.filename() == "..")
    folder = normal(workingFolder() / folder);
  return folder.parent_path();
}

// Path of the labels of a scan; empty if there are none.
std::string
labelsOfScan(const fs::path& scan)
{
  std::vector<std::string> names = {scan.stem().string()};
  if (isOfNuScenes(scan))
    names.push_back(scan.stem().stem().string());
  for (const std::string& name : names)
    for (const fs::path& folder : {scan.parent_path(), folderAbove(scan) / "labels"}) {
      const fs::path file = folder / (name + ".label");
      if (isThere(file))
        return file.string();
    }
  return {};
}

std::string
textOf(const ScanColumns& columns)
{
  std::string text;
  for (const std::string& column : columns)
    text += (text.empty() ? "" : " ") + column;
  return text;
}

// Tells in an error message how to specify other columns.
std::string
hintOf(std::size_t columns)
{
  return std::to_string(columns) + " float32 a point; name them with --scan-columns, " +
         (columns == 3   ? "x,y,z"
          : columns == 4 ? "x,y,z,intensity"
          : columns == 5 ? "x,y,z,intensity,ring as nuScenes has them"
                         : std::to_string(columns) + " or their names");
}

// \param[in] is_known whether the caller specified the columns
void
checkLayout(const std::string& path, const std::vector<std::uint8_t>& bytes,
            const ScanColumns& columns, bool is_known, PcdTable& table)
{
  const std::size_t count = columns.size(), size = count * sizeof(float);
  const ScanLayout layout(bytes);
  if (bytes.empty())
    return addDoubt(table, path + ": is empty: a scan of no points");
  const bool fits = bytes.size() % size == 0;
  const std::size_t others =
      bytes.size() % sizeof(float) == 0 ? layout.columnsInsteadOf(count) : 0;
  if (!fits)
    badInput(path, ": has ", bytes.size(), " bytes, expected a multiple of ", size,
             " (", count, " float32 a point)",
             others > 0 ? "; it looks like " + hintOf(others) : "");
  if (layout.isText())
    badInput(path, ": is text, expected float32 ", textOf(columns));
  if (others > 0 && is_known)
    addDoubt(table, path + ": looks like " + std::to_string(others) +
                        " float32 a point, not " + textOf(columns));
  else if (others > 0)
    badInput(path, ": does not look like ", textOf(columns), ", but like ",
             hintOf(others));
  else if (!is_known && layout.isAbsurd(count))
    badInput(path,
             ": positions are too large or too small for metres, expected float32 ",
             textOf(columns), "; name other columns with --scan-columns");
  else if (!is_known && layout.isSigned(count, 3))
    badInput(path, ": holds negative intensities, expected float32 ", textOf(columns),
             "; name other columns with --scan-columns");
}

} // namespace

ScanColumns
parseScanColumns(const std::string& text)
{
  constexpr std::size_t fewest = 3, most = 16;
  ScanColumns columns;
  if (text.empty())
    return columns;
  std::size_t number = 0;
  if (parseWhole(text, number)) {
    if (number < fewest || number > most)
      badParameter("scan columns: ", number, ", expected ", fewest, " to ", most);
    columns = nuscenes_columns;
    columns.resize(number, kPadding);
    return columns;
  }
  for (const std::string_view word : splitAt(',', text))
    columns.emplace_back(word);
  for (const std::string& column : columns)
    if (column.find(':') != std::string::npos)
      badParameter("scan columns '", text, "': ", inQuotes(column),
                   " states a type, but all columns of a .bin are float32; write "
                   "others as .pcd");
    else if (!isPcdField({column, 0, pcl::PCLPointField::FLOAT32, 1}) ||
             (column != kPadding &&
              std::count(columns.begin(), columns.end(), column) > 1))
      badParameter("scan columns '", text, "': ", inQuotes(column),
                   " is no name, or there twice");
  for (const char* const axis : {"x", "y", "z"})
    if (!std::count(columns.begin(), columns.end(), axis))
      badParameter("scan columns '", text, "' have no ", axis,
                   ", expected their names, x,y,z,intensity, or their number");
  if (columns.size() > most)
    badParameter("scan columns: ", columns.size(), ", expected ", fewest, " to ", most);
  return columns;
}

ScanColumns
parseScanColumns(const std::string& text, const std::string& path)
{
  return boost::algorithm::iends_with(path, ".bin") ? parseScanColumns(text)
                                                    : ScanColumns();
}

PcdTable
readScanPoints(const std::string& path, const ScanColumns& columns)
{
  PcdTable table;
  table.data = readBytes(path);
  const ScanColumns& used = !columns.empty()     ? columns
                            : isOfNuScenes(path) ? nuscenes_columns
                                                 : kitti_columns;
  checkLayout(path, table.data, used, !columns.empty(), table);
  for (const std::string& column : used)
    table.addField(column, pcl::PCLPointField::FLOAT32);
  const std::size_t points = table.data.size() / table.point_step;
  if (points > std::size_t(std::numeric_limits<pcl::index_t>::max()))
    badInput(path, ": has ", points, " points, more than PCL can index");
  table.width = pcl::uindex_t(points);
  table.height = 1;
  table.removeColumns(kPadding);
  return table;
}

PcdTable
readScan(const std::string& path, const ScanColumns& columns)
{
  PcdTable table = readScanPoints(path, columns);
  const std::string labels = labelsOfScan(path);
  if (labels.empty())
    return table;
  const std::vector<std::uint8_t> bytes = readBytes(labels);
  if (bytes.size() != 4 * table.points())
    badInput(labels, ": has ", bytes.size(), " bytes, expected ", 4 * table.points(),
             ": uint32 for each point of ", path);
  table.setColumn({"label", 0, pcl::PCLPointField::UINT32, 1}, bytes.data(),
                  bytes.size());
  return table;
}

} // namespace pcl_semantic
