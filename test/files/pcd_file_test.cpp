// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>

#include <cstring>

using namespace pcl_semantic;

namespace {

constexpr int classes = 11;

template <typename T>
void
append(std::vector<std::uint8_t>& data, const T& value)
{
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&value);
  data.insert(data.end(), bytes, bytes + sizeof(T));
}

float
probabilityOf(std::size_t point, int k)
{
  return float(point) + 0.01f * float(k);
}

PcdTable
someTable(std::size_t points)
{
  PcdTable table;
  table.fields = {{"x", 'F', 4, 1},     {"y", 'F', 4, 1},
                  {"z", 'F', 4, 1},     {"rgba", 'U', 4, 1},
                  {"label", 'U', 4, 1}, {"probability", 'F', 4, classes}};
  table.points = points;
  for (std::size_t i = 0; i < points; ++i) {
    for (const float coordinate : {1.5f * float(i), -2.0f, 1e5f})
      append(table.data, coordinate);
    append(table.data, std::uint32_t(0xFF102030u + i));
    append(table.data, std::uint32_t(i % 12));
    for (int k = 0; k < classes; ++k)
      append(table.data, probabilityOf(i, k));
  }
  return table;
}

} // namespace

TEST(WritePcd, PclReadsThePoints)
{
  const TemporaryFolder folder;
  writePcd(folder.path("a.pcd"), someTable(1000));
  EXPECT_EQ(folder.entries(), 1u);
  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(folder.path("a.pcd"), cloud), 0);
  ASSERT_EQ(cloud.size(), 1000u);
  EXPECT_EQ(cloud.height, 1u);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].x, 1.5f * float(i));
    EXPECT_EQ(cloud[i].z, 1e5f);
    EXPECT_EQ(cloud[i].rgba, 0xFF102030u + i);
    EXPECT_EQ(cloud[i].label, i % 12);
  }
  EXPECT_TRUE(cloud.sensor_origin_.isZero());
  EXPECT_TRUE(cloud.sensor_orientation_.isApprox(Eigen::Quaternionf::Identity()));
}

TEST(WritePcd, PclReadsAFieldOfSeveralElements)
{
  const TemporaryFolder folder;
  writePcd(folder.path("a.pcd"), someTable(100));
  pcl::PCLPointCloud2 cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(folder.path("a.pcd"), cloud), 0);
  const int index = pcl::getFieldIndex(cloud, "probability");
  ASSERT_GE(index, 0);
  EXPECT_EQ(cloud.fields[index].count, unsigned(classes));
  for (std::size_t i = 0; i < 100; ++i)
    for (int k = 0; k < classes; ++k) {
      float value = 0.0f;
      std::memcpy(
          &value,
          &cloud.data[i * cloud.point_step + cloud.fields[index].offset + 4 * k], 4);
      EXPECT_EQ(value, probabilityOf(i, k));
    }
}

TEST(WritePcd, AnEmptyCloudIsValid)
{
  const TemporaryFolder folder;
  writePcd(folder.path("a.pcd"), someTable(0));
  const std::string header = bytesOf(folder.path("a.pcd"));
  EXPECT_TRUE(holds(header, "\nPOINTS 0\nDATA binary\n"));
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, type = 0;
  unsigned offset = 0;
  pcl::PCDReader reader;
  EXPECT_EQ(reader.readHeader(folder.path("a.pcd"), cloud, origin, orientation, version,
                              type, offset),
            0);
  EXPECT_EQ(cloud.width * cloud.height, 0u);
  EXPECT_EQ(cloud.fields.size(), 6u);
}

TEST(WritePcd, RefusesDataThatDoNotFitTheFields)
{
  const TemporaryFolder folder;
  PcdTable table = someTable(10);
  table.data.pop_back();
  thrownMessage<InvalidParameterException>(
      [&] { writePcd(folder.path("a.pcd"), table); });
  thrownMessage<InvalidParameterException>(
      [&] { writePcd(folder.path("a.pcd"), PcdTable()); });
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(WritePcd, LeavesNothingBehindWhenItFails)
{
  const TemporaryFolder folder;
  const PcdTable table = someTable(10000);
  const FullDisk full(100000);
  thrownMessage<OutputException>([&] { writePcd(folder.path("a.pcd"), table); });
  EXPECT_EQ(folder.entries(), 0u);
}
