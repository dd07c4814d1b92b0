// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/colour_cloud_file.h>

#include <pcl/io/pcd_io.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pcl_semantic {

TEST(ColourCloudFile, PclReadsTheOrganizedCloud)
{
  const TemporaryFolder folder;
  pcl::PointCloud<pcl::PointXYZRGB> cloud(3, 2), read;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i] = {std::uint8_t(i), std::uint8_t(40 * i), std::uint8_t(255 - i)};
    cloud[i].getVector3fMap() << float(i), 0.5f, -2.0f;
  }
  cloud[4].x = cloud[4].y = cloud[4].z = std::numeric_limits<float>::quiet_NaN();
  cloud.sensor_origin_ << 1.0f, 2.0f, 3.0f, 0.0f;
  writeColourCloud(folder.path("cloud.pcd"), cloud);
  ASSERT_EQ(pcl::io::loadPCDFile(folder.path("cloud.pcd"), read), 0);
  ASSERT_EQ(read.width, 3u);
  ASSERT_EQ(read.height, 2u);
  EXPECT_FALSE(read.is_dense);
  EXPECT_TRUE(read.sensor_origin_.isApprox(cloud.sensor_origin_));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_TRUE(read[i].r == cloud[i].r && read[i].g == cloud[i].g &&
                read[i].b == cloud[i].b)
        << i;
    if (i == 4)
      EXPECT_TRUE(std::isnan(read[i].x) && std::isnan(read[i].z));
    else
      EXPECT_EQ(read[i].getVector3fMap(), cloud[i].getVector3fMap());
  }
  cloud.width = 4; // not the size of the points
  EXPECT_THROW(writeColourCloud(folder.path("cloud.pcd"), cloud),
               InvalidParameterException);
}

} // namespace pcl_semantic
