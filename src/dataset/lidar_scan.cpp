// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/lidar_scan.h>

#include "core/fail.h"
#include "files/bytes.h"
#include "files/scan_file.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <cmath>
#include <cstring>

namespace pcl_semantic {

pcl::PointCloud<pcl::PointXYZI>::Ptr
readVelodyneScan(const std::string& path, const ScanColumns& columns)
{
  const PcdTable table = readScanPoints(path, columns);
  const PcdColumn x(table, table.find("x")), y(table, table.find("y")),
      z(table, table.find("z"));
  const int intensity = table.find("intensity");
  pcl::PointCloud<pcl::PointXYZI>::Ptr scan(new pcl::PointCloud<pcl::PointXYZI>);
  scan->resize(table.points());
  for (std::size_t i = 0; i < scan->size(); ++i) {
    pcl::PointXYZI& point = (*scan)[i];
    point.x = float(x(i));
    point.y = float(y(i));
    point.z = float(z(i));
    point.intensity = intensity < 0 ? 0.0f : float(PcdColumn(table, intensity)(i));
    for (const float value : {point.x, point.y, point.z, point.intensity})
      if (!std::isfinite(value))
        fail<BadInputException>(path, ": point ", i,
                                " has a number that is not finite");
  }
  return scan;
}

namespace {

std::uint32_t
numberOf(const std::vector<std::uint8_t>& bytes, std::size_t i)
{
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + i * sizeof(value), sizeof(value));
  return value;
}

} // namespace

std::vector<std::uint32_t>
readScanNumbers(const std::string& path)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  if (bytes.size() % sizeof(std::uint32_t) != 0)
    fail<BadInputException>(path, ": has ", bytes.size(),
                            " bytes, expected uint32 for each point of a scan");
  std::vector<std::uint32_t> numbers(bytes.size() / sizeof(std::uint32_t));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = numberOf(bytes, i);
  return numbers;
}

std::vector<Label>
readSemanticKittiLabels(const std::string& path, const LabelMapping& mapping,
                        std::size_t count)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  if (bytes.size() != count * sizeof(std::uint32_t))
    fail<BadInputException>(path, ": has ", bytes.size(), " bytes, expected ",
                            count * sizeof(std::uint32_t), " (uint32 for each of ",
                            count, " points of the scan)");
  std::vector<Label> labels(count);
  for (std::size_t i = 0; i < count; ++i)
    labels[i] = mapping(numberOf(bytes, i));
  return labels;
}

std::vector<Label>
readScanLabels(const std::string& path, int classes)
{
  const std::vector<std::uint32_t> numbers = readScanNumbers(path);
  std::vector<Label> labels(numbers.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::uint32_t value = classOf(numbers[i]);
    if (value > std::uint32_t(classes))
      fail<BadInputException>(path, ": point ", i, " has class ", value,
                              ", expected 0 to ", classes);
    labels[i] = static_cast<Label>(value);
  }
  return labels;
}

void
writeScanLabels(const std::string& path, const std::vector<Label>& labels,
                const std::vector<std::uint32_t>& objects)
{
  std::vector<std::uint32_t> values(labels.begin(), labels.end());
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (objects[i] <= kMaxScanObject)
      values[i] |= objects[i] << 16;
  ByteWriter bytes;
  bytes.putColumn(values);
  AtomicFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.bytes().data()),
                      std::streamsize(bytes.bytes().size()));
  file.commit();
}

} // namespace pcl_semantic
