// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/colour_cloud_file.h>

#include <pcl_semantic/files/cloud_file.h>

#include <cstring>

namespace pcl_semantic {

void
writeColourCloud(const std::string& path,
                 const pcl::PointCloud<pcl::PointXYZRGB>& cloud)
{
  PcdTable table;
  table.fields = {{"x"}, {"y"}, {"z"}, {"rgb"}};
  table.points = cloud.size();
  table.width = cloud.width;
  table.height = cloud.height;
  const std::size_t size = table.pointSize();
  table.data.resize(cloud.size() * size);
  std::uint8_t* row = table.data.data();
  for (const pcl::PointXYZRGB& point : cloud) {
    std::memcpy(row, point.data, 3 * sizeof(float));
    std::memcpy(row + 3 * sizeof(float), &point.rgb, sizeof(float));
    row += size;
  }
  const Eigen::Vector4f& origin = cloud.sensor_origin_;
  const Eigen::Quaternionf& turn = cloud.sensor_orientation_;
  table.viewpoint = {origin.x(), origin.y(), origin.z(), turn.w(),
                     turn.x(),   turn.y(),   turn.z()};
  writeCloudTable(path, table);
}

} // namespace pcl_semantic
