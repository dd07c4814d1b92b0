// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/colour_cloud_file.h>

#include "clouds/table_parts.h"

#include <pcl_semantic/files/cloud_file.h>

namespace pcl_semantic {

void
writeColourCloud(const std::string& path,
                 const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                 const Eigen::Vector3d& origin)
{
  writeCloudTable(path, tableOfPoints(cloud, origin));
}

} // namespace pcl_semantic
