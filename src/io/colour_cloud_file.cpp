// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/colour_cloud_file.h>

#include <pcl_semantic/files/cloud_file.h>

#include <cstring>

namespace pcl_semantic {

void
writeColourCloud(const std::string& path,
                 const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                 const Eigen::Vector3d& origin)
{
  const bool is_far = !origin.isZero(0.0);
  PcdTable table;
  const int size_of_number = is_far ? sizeof(double) : sizeof(float);
  for (const char* const name : {"x", "y", "z"})
    table.fields.push_back({name, 'F', size_of_number});
  table.fields.push_back({"rgb"});
  table.points = cloud.size();
  table.width = cloud.width;
  table.height = cloud.height;
  const std::size_t size = table.pointSize();
  table.data.resize(cloud.size() * size);
  std::uint8_t* row = table.data.data();
  for (const pcl::PointXYZRGB& point : cloud) {
    const Eigen::Vector3d position = point.getVector3fMap().cast<double>() + origin;
    const void* const numbers =
        is_far ? static_cast<const void*>(position.data()) : point.data;
    std::memcpy(row, numbers, size - sizeof(float));
    std::memcpy(row + size - sizeof(float), &point.rgb, sizeof(float));
    row += size;
  }
  const Eigen::Vector4f& sensor = cloud.sensor_origin_;
  const Eigen::Quaternionf& turn = cloud.sensor_orientation_;
  table.viewpoint = {sensor.x(), sensor.y(), sensor.z(), turn.w(),
                     turn.x(),   turn.y(),   turn.z()};
  writeCloudTable(path, table);
}

} // namespace pcl_semantic
