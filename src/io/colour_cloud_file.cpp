// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/colour_cloud_file.h>

#include "files/pcd_table.h"

namespace pcl_semantic {

void
writeColourCloud(const std::string& path,
                 const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                 const Eigen::Vector3d& origin)
{
  PcdTable table = tableOfPoints(cloud);
  const char* const names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3 && !origin.isZero(0.0); ++axis) {
    std::vector<double> values;
    for (const pcl::PointXYZRGB& point : cloud)
      values.push_back(double(point.data[axis]) + origin[axis]);
    table.setColumn(names[axis], values);
  }
  writeCloudTable(path, table);
}

} // namespace pcl_semantic
