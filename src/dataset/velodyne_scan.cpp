// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/velodyne_scan.h>
#include <pcl_semantic/files/input_file.h>

#include <array>
#include <cmath>
#include <cstring>

namespace pcl_semantic {

pcl::PointCloud<pcl::PointXYZI>::Ptr
readVelodyneScan(const std::string& path)
{
  using Record = std::array<float, 4>;
  const std::vector<std::uint8_t> bytes = readBytes(path);
  if (bytes.empty() || bytes.size() % sizeof(Record) != 0)
    PCL_THROW_EXCEPTION(
        BadInputException,
        path << ": has " << bytes.size()
             << " bytes, expected a multiple of 16 (4 float32 a point)");
  pcl::PointCloud<pcl::PointXYZI>::Ptr scan(new pcl::PointCloud<pcl::PointXYZI>);
  scan->resize(bytes.size() / sizeof(Record));
  for (std::size_t i = 0; i < scan->size(); ++i) {
    Record record;
    std::memcpy(record.data(), bytes.data() + i * sizeof(Record), sizeof(Record));
    for (const float value : record)
      if (!std::isfinite(value))
        PCL_THROW_EXCEPTION(BadInputException,
                            path << ": point " << i
                                 << " has a number that is not finite");
    pcl::PointXYZI& point = (*scan)[i];
    point.x = record[0];
    point.y = record[1];
    point.z = record[2];
    point.intensity = record[3];
  }
  return scan;
}

} // namespace pcl_semantic
