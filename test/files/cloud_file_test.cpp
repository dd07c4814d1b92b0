// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
#include "support/kitti11.h"
#include "support/refused_file.h"

#include <pcl_semantic/clouds/point_cloud2.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <gtest/gtest.h>

#include <pcl/conversions.h>

#include <filesystem>

namespace {

using namespace pcl_semantic;
namespace fs = std::filesystem;

const std::string kHeader = "element vertex 2\nproperty float x\nproperty float y\n"
                            "property float z\nproperty uchar red\n"
                            "property uchar green\nproperty uchar blue\n"
                            "property int scalar_Label\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";

template <typename T>
std::string
bytes(std::initializer_list<T> values)
{
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T)};
}

void
expectTwoPoints(const LabelledCloud& cloud)
{
  ASSERT_EQ(cloud.cloud->size(), 2u);
  EXPECT_EQ((*cloud.cloud)[1].x, 4.0f);
  EXPECT_EQ((*cloud.cloud)[0].label, 3u);
  EXPECT_EQ((*cloud.cloud)[1].label, 0u);
  EXPECT_TRUE(cloud.has_colour);
  EXPECT_EQ((*cloud.cloud)[0].r, 10);
  EXPECT_EQ((*cloud.cloud)[0].b, 30);
}

::testing::AssertionResult
refuses(const std::string& name, const std::string& content, const std::string& part)
{
  return refusesFile(name, content, part,
                     [](const std::string& path) { readCloudTable(path); });
}

} // namespace

// Bytes become rgba; other numbers are read as colours, too, but stay.
TEST(CloudFile, KeepsWiderColoursOfPly)
{
  const TemporaryFolder folder;
  for (const char* const type : {"ushort", "char", "float"}) {
    const std::string property = type + std::string(":");
    folder.write("a.ply", asciiPly("x " + property + "red " + property + "green " +
                                       property + "blue",
                                   "1 100 20 3\n"));
    const PcdTable table = readCloudTable(folder.path("a.ply"));
    ASSERT_GE(table.find("rgba"), 0) << type;
    EXPECT_EQ(PcdColumn(table, table.find("rgba")).bits(0), 0xFF641403u) << type;
    ASSERT_GE(table.find("red"), 0) << type;
    EXPECT_EQ(PcdColumn(table, table.find("red"))(0), 100.0) << type;
  }
}

// Whatever file it comes from; what follows a point is dropped padding.
TEST(CloudFile, ATableIsACloudOfPcl)
{
  const TemporaryFolder folder;
  folder.write("a.pcd", "FIELDS x y z _\nSIZE 4 4 4 4\nTYPE F F F U\nWIDTH 1\n"
                        "HEIGHT 2\nDATA ascii\n1 2 3 9\n4 5 6 9\n");
  folder.write("a.ply", asciiPly("x y z", "1 2 3\n4 5 6\n"));
  folder.write("a.bin", bytes<float>({1, 2, 3, 0.5f, 4, 5, 6, 0.25f}));
  for (const char* const name : {"a.pcd", "a.ply", "a.bin"}) {
    const PcdTable table = readCloudTable(folder.path(name));
    EXPECT_EQ(table.row_step, table.width * table.point_step) << name;
    pcl::PointCloud<pcl::PointXYZ> cloud;
    pcl::fromPCLPointCloud2(table, cloud);
    ASSERT_EQ(cloud.size(), 2u) << name;
    EXPECT_EQ(cloud.height, name == std::string("a.pcd") ? 2u : 1u);
    EXPECT_EQ(cloud[0].x, 1.0f) << name;
    EXPECT_EQ(cloud[1].z, 6.0f) << name;
  }
}

TEST(CloudFile, ReadsPly)
{
  const TemporaryFolder folder;
  folder.write("a.ply", "ply\nformat ascii 1.0\ncomment by hand\n" + kHeader + kFaces +
                            "end_header\n1 2 3 10 20 30 3\n4 5 6 7 8 9 0\n3 0 1 1\n");
  expectTwoPoints(readLabelledCloud(folder.path("a.ply")));
  folder.write("b.PLY", "ply\nformat binary_little_endian 1.0\n" + kHeader + kFaces +
                            "end_header\n" + bytes<float>({1, 2, 3}) +
                            bytes<std::uint8_t>({10, 20, 30}) +
                            bytes<std::int32_t>({3}) + bytes<float>({4, 5, 6}) +
                            bytes<std::uint8_t>({7, 8, 9}) + bytes<std::int32_t>({0}) +
                            bytes<std::uint8_t>({3}) + bytes<std::int32_t>({0, 1, 1}));
  expectTwoPoints(readLabelledCloud(folder.path("b.PLY")));
}

TEST(CloudFile, RefusesDamagedPlyWithFileAndLine)
{
  const std::string ascii = "ply\nformat ascii 1.0\n", end = "end_header\n";
  const std::string one = ascii + "element vertex 1\n";
  const std::pair<std::string, const char*> cases[] = {
      {"", "does not begin with 'ply'"},
      {ascii + kHeader, "has no end_header"},
      {"ply\n" + kHeader + end, "has no format"},
      {"ply\nformat binary_big_endian 1.0\n", "line 2: format"},
      {ascii + kFaces, "vertices have to be the first"},
      {ascii + "element vertex -1\n", "line 3: "},
      {ascii + "element vertex 1e30\n", "line 3: "},
      {one + "property list uchar int a\n", "line 4: property of type 'list'"},
      {one + "property int a\nproperty int a\n", "line 5: "},
      {ascii + kHeader + end + "1 2 3 4 5 6 7\n", "has 1 points, expected 2"},
      {ascii + kHeader + end + "1 2 3 4 5 256 7\n", "line 12: "},
      {"ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\n"
       "property double x\n" +
           end,
       "holds 0 bytes of data"}};
  for (const auto& [content, part] : cases)
    EXPECT_TRUE(refuses("a.ply", content, part));
}

// The upper half of a label is the number of a thing, which is no class.
TEST(CloudFile, ReadsScansWithTheLabelsThatBelongToThem)
{
  const TemporaryFolder folder;
  fs::create_directories(folder.path("velodyne"));
  fs::create_directories(folder.path("labels"));
  folder.write("velodyne/000001.bin", bytes<float>({1, 2, 3, 0.5f, 4, 5, 6, 0.25f}));
  EXPECT_EQ(readCloudTable(folder.path("velodyne/000001.bin")).find("label"), -1);
  for (const char* const labels : {"labels/000001.label", "velodyne/000001.label"}) {
    folder.write(labels, bytes<std::uint32_t>({0xFFFF000Au, 0xABCD0102u}));
    const PcdTable table = readCloudTable(folder.path("velodyne/000001.bin"));
    const PcdColumn label(table, table.find("label")), z(table, table.find("z"));
    EXPECT_EQ(label.bits(0), 0x0Au);
    EXPECT_EQ(label.bits(1), 0x102u);
    EXPECT_EQ(z(1), 6.0);
    EXPECT_EQ(PcdColumn(table, table.find("intensity"))(1), 0.25);
    fs::remove(folder.path(labels));
  }
  folder.write("labels/000001.label", "1234");
  expectBadInput("labels/000001.label: has 4 bytes, expected 8",
                 [&] { readCloudTable(folder.path("velodyne/000001.bin")); });
  EXPECT_TRUE(refuses("half.bin", "12345678", "a multiple of 16"));
}

TEST(CloudFile, MapsNumbersToLabels)
{
  const LabelSet label_set = readLabelSet(kitti11);
  const LabelMapping kitti = readLabelMapping("semantic_kitti_to_kitti11", label_set);
  const LabelMapping zero_based = readLabelMapping("zero_based", label_set);
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "a.ply", asciiPly("x y z int:label", "1 2 3 252\n1 2 3 -1\n1 2 3 0\n1 2 3 40\n"));
  const auto labels = [&](const LabelMapping& mapping) {
    std::vector<std::uint32_t> all;
    const auto cloud = readLabelledCloud(path, &mapping).cloud;
    for (const pcl::PointXYZRGBL& point : *cloud)
      all.push_back(point.label);
    return all;
  };
  EXPECT_EQ(labels(kitti), (std::vector<std::uint32_t>{label_set.find("car"), 0, 0,
                                                       label_set.find("road")}));
  EXPECT_EQ(labels(zero_based), (std::vector<std::uint32_t>{0, 0, 1, 0}));
  expectBadInput(
      "field 'label' of point 1 is -1, expected a whole number from 0 to 255, or a "
      "label mapping",
      [&] { readLabelledCloud(path); });
  expectBadInput("semantic_kiti",
                 [&] { readLabelMapping("semantic_kiti", label_set); });
}

TEST(PointCloud2, HoldsAllOfAVoxelCloud)
{
  VoxelCloud voxels;
  for (int i = 0; i < 3; ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() << 0.1f * float(i), -2.0f, 3.0f;
    point.rgba = 0xFF010203u + std::uint32_t(i);
    point.label = std::uint32_t(i);
    voxels.cloud->push_back(point);
    voxels.indices.emplace_back(i, -20, 1000000 + i);
    voxels.observations.push_back(std::uint32_t(7 + i));
  }
  voxels.cloud->header.frame_id = "world";
  voxels.measured = LabelDistributions(2, 3);
  voxels.refined = LabelDistributions(2, 3);
  voxels.measured.matrix() << 0.25f, 0.1f, 0.0f, 0.75f, 0.9f, 0.0f;
  voxels.refined.matrix() << 1.0f, 0.3f, 0.5f, 0.0f, 0.7f, 0.5f;
  voxels.voxel_size = 0.1;
  voxels.origin << 4000.0, -1000.0, 1.0 / 3.0;
  pcl::PCLPointCloud2 blob;
  toPCLPointCloud2(voxels, blob);
  VoxelCloud back;
  fromPCLPointCloud2(blob, back);
  ASSERT_EQ(back.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ((*back.cloud)[i].getVector3fMap(), (*voxels.cloud)[i].getVector3fMap());
    EXPECT_EQ((*back.cloud)[i].rgba, (*voxels.cloud)[i].rgba);
    EXPECT_EQ((*back.cloud)[i].label, (*voxels.cloud)[i].label);
  }
  EXPECT_EQ(back.cloud->header.frame_id, "world");
  EXPECT_EQ(back.indices, voxels.indices);
  EXPECT_EQ(back.observations, voxels.observations);
  EXPECT_EQ(back.measured.matrix(), voxels.measured.matrix());
  EXPECT_EQ(back.refined.matrix(), voxels.refined.matrix());
  EXPECT_EQ(back.voxel_size, voxels.voxel_size);
  EXPECT_EQ(back.origin, voxels.origin);

  voxels.observations.pop_back();
  EXPECT_THROW(toPCLPointCloud2(voxels, blob), InvalidParameterException);
  blob.fields[0].name = "u";
  expectBadParameter("has no field 'x'", [&] { fromPCLPointCloud2(blob, back); });
  blob.data.pop_back();
  expectBadParameter("bytes for 3 x 1 points", [&] { fromPCLPointCloud2(blob, back); });
  blob.data.push_back(0);
  blob.fields[0].offset = blob.point_step;
  expectBadParameter("ends beyond its point", [&] { PcdTable table(blob); });
}
