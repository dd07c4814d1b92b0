// SPDX-License-Identifier: BSD-3-Clause

// Writing, and reading what PCL and we write; bad files are in pcd_bad_input_test.cpp.

#include "files/pcd_file.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

using namespace pcl_semantic;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Values of all kinds, organized; smooth enough to compress and too rough to shrink to
// nothing.
pcl::PointCloud<pcl::PointXYZRGBL>
someCloud(unsigned width, unsigned height)
{
  std::mt19937 random(5);
  pcl::PointCloud<pcl::PointXYZRGBL> cloud(width, height);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].x = 0.1f * float(i % 50);
    cloud[i].y = std::uniform_real_distribution<float>(-50.0f, 50.0f)(random);
    cloud[i].z = i % 7 == 3 ? kNaN : 1e-7f * float(i);
    cloud[i].rgba = random();
    cloud[i].label = unsigned(i / 10 % 12);
  }
  cloud.sensor_origin_ = {1.5f, -2.25f, 0.1f, 0.0f};
  cloud.sensor_orientation_ = Eigen::Quaternionf(0.5f, 0.5f, -0.5f, 0.5f);
  return cloud;
}

void
expectSame(const PcdTable& table, const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  std::string names;
  for (const pcl::PCLPointField& field : table.fields)
    names += field.name + pcl::getFieldType(field.datatype) +
             std::to_string(pcl::getFieldSize(field.datatype)) + " ";
  ASSERT_EQ(names, "xF4 yF4 zF4 rgbaU4 labelU4 ");
  ASSERT_EQ(table.points(), cloud.size());
  EXPECT_EQ(table.width, cloud.width);
  EXPECT_EQ(table.height, cloud.height);
  const PcdColumn x(table, 0), y(table, 1), z(table, 2), rgba(table, 3),
      label(table, 4);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(x(i), cloud[i].x) << i;
    // PCL writes eight digits.
    ASSERT_NEAR(y(i), cloud[i].y, std::abs(cloud[i].y) * 1e-7) << i;
    ASSERT_EQ(std::isnan(z(i)), std::isnan(cloud[i].z)) << i;
    if (!std::isnan(z(i))) {
      ASSERT_NEAR(z(i), cloud[i].z, std::abs(cloud[i].z) * 1e-7) << i;
    }
    ASSERT_EQ(rgba.bits(i), cloud[i].rgba) << i;
    ASSERT_EQ(label(i), cloud[i].label) << i;
  }
  const double expected[] = {1.5, -2.25, 0.1, 0.5, 0.5, -0.5, 0.5};
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR(table.viewpoint[std::size_t(i)], expected[i], 1e-6) << i;
}

// All of PCL's writers, from clouds and from messages.
template <typename PointT>
std::vector<std::string>
writeWithPcl(const TemporaryFolder& folder, const pcl::PointCloud<PointT>& cloud)
{
  pcl::PCLPointCloud2 message;
  pcl::toPCLPointCloud2(cloud, message);
  const Eigen::Vector4f origin = cloud.sensor_origin_;
  const Eigen::Quaternionf orientation = cloud.sensor_orientation_;
  pcl::PCDWriter writer;
  std::vector<std::string> paths;
  const auto path = [&](const char* name) {
    paths.push_back(folder.path(name));
    return paths.back();
  };
  EXPECT_EQ(pcl::io::savePCDFileASCII(path("a.pcd"), cloud), 0);
  EXPECT_EQ(pcl::io::savePCDFileBinary(path("b.pcd"), cloud), 0);
  EXPECT_EQ(pcl::io::savePCDFileBinaryCompressed(path("c.pcd"), cloud), 0);
  EXPECT_EQ(writer.writeASCII(path("d.pcd"), message, origin, orientation), 0);
  EXPECT_EQ(writer.writeBinary(path("e.pcd"), message, origin, orientation), 0);
  EXPECT_EQ(writer.writeBinaryCompressed(path("f.pcd"), message, origin, orientation),
            0);
  return paths;
}

// The value of an ascii file of one point with one field.
double
readValue(const std::string& type, int size, const std::string& value)
{
  const TemporaryFolder folder;
  const PcdTable table = readPcd(folder.write(
      "a.pcd", "FIELDS v\nSIZE " + std::to_string(size) + "\nTYPE " + type +
                   "\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nDATA ascii\n" +
                   value + "\n"));
  EXPECT_EQ(table.points(), 1u);
  return PcdColumn(table, 0)(0);
}

// Fields of every type and any bytes.
PcdTable
everyType()
{
  using Field = pcl::PCLPointField;
  PcdTable table;
  const std::uint8_t types[] = {Field::INT8,    Field::UINT8,  Field::INT16,
                                Field::UINT16,  Field::INT32,  Field::UINT32,
                                Field::INT64,   Field::UINT64, Field::FLOAT32,
                                Field::FLOAT64, Field::BOOL};
  for (const std::uint8_t type : types)
    table.addField(std::string(1, char('a' + table.fields.size())), type,
                   type == Field::UINT8     ? 3
                   : type == Field::FLOAT32 ? 11
                                            : 1);
  table.width = 4;
  table.height = 3;
  table.viewpoint = {0.1, -2e6, 3.0, 0.5, 0.5, 0.5, -0.5};
  table.data.resize(table.points() * table.point_step);
  for (std::size_t i = 0; i < table.data.size(); ++i)
    table.data[i] = std::uint8_t(31 * i);
  return table;
}

} // namespace

TEST(ReadPcd, ReadsAllThatPclWrites)
{
  for (const auto& [width, height] :
       {std::pair(64u, 48u), std::pair(1u, 1u), std::pair(977u, 1u)}) {
    const TemporaryFolder folder;
    const pcl::PointCloud<pcl::PointXYZRGBL> cloud = someCloud(width, height);
    for (const std::string& path : writeWithPcl(folder, cloud)) {
      SCOPED_TRACE(path);
      expectSame(readPcd(path), cloud);
    }
  }
}

TEST(ReadPcd, ReadsPclsEmptyClouds)
{
  const TemporaryFolder folder;
  for (const std::string& path :
       writeWithPcl(folder, pcl::PointCloud<pcl::PointXYZRGBL>())) {
    const PcdTable table = readPcd(path);
    EXPECT_EQ(table.points(), 0u) << path;
    EXPECT_EQ(table.fields.size(), 5u) << path;
  }
}

// As whole numbers, and as floats from messages.
TEST(ReadPcd, ReadsPclsPackedColours)
{
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  for (int i = 0; i < 300; ++i)
    cloud.push_back({float(i), 2.0f, 3.0f, std::uint8_t(i), std::uint8_t(7 * i), 200});
  const TemporaryFolder folder;
  for (const std::string& path : writeWithPcl(folder, cloud)) {
    const PcdTable table = readPcd(path);
    ASSERT_EQ(table.fields.size(), 4u) << path;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      ASSERT_EQ(PcdColumn(table, 3).bits(i), cloud[i].rgba) << path;
  }
}

TEST(ReadPcd, ReadsCompressedDataOfAllLengths)
{
  // Runs, repetitions and noise, so that every form of LZF's codes occurs.
  for (const unsigned points : {1u, 2u, 3u, 10u, 33u, 100u, 1000u, 70000u}) {
    pcl::PointCloud<pcl::PointXYZRGBL> cloud = someCloud(points, 1);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (i % 500 < 400)
        cloud[i].rgba = i % 500 < 200 ? 0xFF000000u : unsigned(i % 3);
    const TemporaryFolder folder;
    pcl::io::savePCDFileBinaryCompressed(folder.path("a.pcd"), cloud);
    expectSame(readPcd(folder.path("a.pcd")), cloud);
  }
}

TEST(ReadPcd, ReadsWhatWasWritten)
{
  const TemporaryFolder folder;
  const PcdTable table = everyType();
  writeCloudTable(folder.path("a.pcd"), table);
  const PcdTable read = readPcd(folder.path("a.pcd"));
  EXPECT_EQ(read.data, table.data);
  EXPECT_EQ(read.width, 4u);
  EXPECT_EQ(read.height, 3u);
  EXPECT_EQ(read.viewpoint, table.viewpoint);
  ASSERT_EQ(read.fields.size(), table.fields.size());
  for (std::size_t i = 0; i < read.fields.size(); ++i) {
    EXPECT_EQ(read.fields[i].name, table.fields[i].name);
    EXPECT_EQ(read.fields[i].offset, table.fields[i].offset);
    EXPECT_EQ(read.fields[i].datatype, table.fields[i].datatype);
    EXPECT_EQ(read.fields[i].count, table.fields[i].count);
  }
}

TEST(ReadPcd, AcceptsWhatEditorsLeaveBehind)
{
  const TemporaryFolder folder;
  const PcdTable table = readPcd(
      folder.write("a.pcd", "\xEF\xBB\xBF# a comment\r\n\r\nVERSION .7\r\nTYPE F I\r\n"
                            "  FIELDS x\tn \r\nSIZE 4 2\r\nWIDTH 2\r\nHEIGHT 1\r\n"
                            "DATA ascii\r\n\r\n 1.5\t-3 \r\n+2e3   4\r\n\r\n"));
  ASSERT_EQ(table.points(), 2u);
  EXPECT_EQ(PcdColumn(table, 0)(0), 1.5);
  EXPECT_EQ(PcdColumn(table, 0)(1), 2000.0);
  EXPECT_EQ(PcdColumn(table, 1)(0), -3.0);
  EXPECT_EQ(PcdColumn(table, 1)(1), 4.0);
}

TEST(ReadPcd, ReadsEveryTypeToItsLimits)
{
  for (const auto& [type, size, text] :
       {std::tuple("I", 1, "-128"), std::tuple("U", 1, "255"),
        std::tuple("I", 2, "-32768"), std::tuple("U", 2, "65535"),
        std::tuple("I", 4, "-2147483648"), std::tuple("U", 4, "4294967295"),
        std::tuple("I", 8, "-9007199254740992"), std::tuple("U", 8, "9007199254740992"),
        std::tuple("B", 1, "1"), std::tuple("F", 8, "1e308"),
        std::tuple("F", 8, "0.1")})
    EXPECT_EQ(readValue(type, size, text), std::stod(text));
  EXPECT_EQ(readValue("F", 4, "3.4028235e38"), double(3.4028235e38f));
  EXPECT_EQ(readValue("F", 4, "1e-45"), double(1e-45f));
  EXPECT_EQ(readValue("F", 4, "-1e-60"), 0.0);
  EXPECT_EQ(readValue("F", 4, "-inf"), -std::numeric_limits<double>::infinity());
  for (const int size : {4, 8})
    for (const char* const word : {"nan", "NaN", "-nan"})
      EXPECT_TRUE(std::isnan(readValue("F", size, word))) << word;
}

TEST(ReadPcd, AFloatsBitsSurviveText)
{
  std::mt19937 random(11);
  for (int i = 0; i < 30; ++i) {
    float value;
    const std::uint32_t bits = random() & 0xFF7FFFFFu; // no infinity or NaN
    std::memcpy(&value, &bits, sizeof(value));
    char text[40];
    std::snprintf(text, sizeof(text), "%.9g", double(value));
    const auto read = float(readValue("F", 4, text));
    EXPECT_EQ(std::memcmp(&read, &bits, sizeof(bits)), 0) << text;
  }
}

TEST(WriteCloudTable, PclReadsThePoints)
{
  const TemporaryFolder folder;
  const pcl::PointCloud<pcl::PointXYZRGBL> written = someCloud(50, 20);
  const PcdTable plain = readPcd(writeWithPcl(folder, written)[1]);
  PcdTable table = plain;
  constexpr int classes = 11;
  std::vector<float> probabilities;
  for (std::size_t i = 0; i < classes * written.size(); ++i)
    probabilities.push_back(0.01f * float(i));
  table.setColumn("probability", probabilities, classes);
  const std::size_t entries = folder.entries();
  writeCloudTable(folder.path("ours.pcd"), table);
  EXPECT_EQ(folder.entries(), entries + 1);

  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(folder.path("ours.pcd"), cloud), 0);
  expectSame(plain, cloud);
  pcl::PCLPointCloud2 message;
  ASSERT_EQ(pcl::io::loadPCDFile(folder.path("ours.pcd"), message), 0);
  const int index = pcl::getFieldIndex(message, "probability");
  ASSERT_GE(index, 0);
  const pcl::PCLPointField& field = message.fields[std::size_t(index)];
  EXPECT_EQ(field.count, unsigned(classes));
  for (std::size_t i = 0; i < written.size(); ++i)
    EXPECT_EQ(std::memcmp(&message.data[i * message.point_step + field.offset],
                          &probabilities[i * classes], classes * sizeof(float)),
              0);
}

TEST(WriteCloudTable, AnEmptyCloudIsValid)
{
  const TemporaryFolder folder;
  PcdTable table;
  table.addField("x", pcl::PCLPointField::FLOAT32);
  table.addField("label", pcl::PCLPointField::UINT32);
  table.addField("probability", pcl::PCLPointField::FLOAT32, 11);
  writeCloudTable(folder.path("a.pcd"), table);
  EXPECT_TRUE(holds(bytesOf(folder.path("a.pcd")), "\nPOINTS 0\nDATA binary\n"));
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, type = 0;
  unsigned offset = 0;
  EXPECT_EQ(pcl::PCDReader().readHeader(folder.path("a.pcd"), cloud, origin,
                                        orientation, version, type, offset),
            0);
  EXPECT_EQ(cloud.width * cloud.height, 0u);
  EXPECT_EQ(cloud.fields.size(), 3u);
  EXPECT_TRUE(origin.isZero());
  EXPECT_TRUE(orientation.isApprox(Eigen::Quaternionf::Identity()));
}

TEST(WriteCloudTable, LeavesNothingBehindWhenItFails)
{
  const TemporaryFolder folder;
  PcdTable cut = everyType(), wide = everyType(), beyond = everyType();
  cut.data.pop_back();
  wide.width = 5;
  beyond.fields[2].offset = beyond.point_step - 1;
  for (const PcdTable& table : {cut, wide, beyond, PcdTable()})
    thrownMessage<InvalidParameterException>(
        [&] { writeCloudTable(folder.path("a.pcd"), table); });
  EXPECT_EQ(folder.entries(), 0u);
}

// As PCL wrote padding between fields of Ouster's points that touch.
TEST(PcdFile, ReadsPaddingOfNoBytes)
{
  const TemporaryFolder folder;
  const std::uint32_t row[] = {0x3F800000, 0x40000000, 0x40400000, 5, 0};
  for (const std::string counts : {"1 1 1 0 1 4", "1 1 1 0 1 4\n# and a comment"}) {
    const std::string path = folder.write(
        "a.pcd",
        "VERSION 0.7\nFIELDS x y z _ label _\nSIZE 4 4 4 1 4 1\nTYPE F F F U U "
        "U\nCOUNT " +
            counts + "\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n" +
            std::string(reinterpret_cast<const char*>(row), 20));
    const PcdTable table = readPcd(path);
    ASSERT_EQ(table.fields.size(), 4u);
    EXPECT_EQ(PcdColumn(table, 2)(0), 3.0);
    EXPECT_EQ(PcdColumn(table, 3)(0), 5.0);
  }
}

TEST(PcdTable, ColumnsAreReplacedAppendedAndRemoved)
{
  using Bytes = std::vector<std::uint8_t>;
  const TemporaryFolder folder;
  PcdTable table;
  for (const char* const name : {"a", "_", "b"})
    table.addField(name, pcl::PCLPointField::UINT8);
  table.width = 2;
  table.height = 1;
  table.data = {1, 0, 2, 11, 0, 12};
  const auto written = [&] {
    writeCloudTable(folder.path("a.pcd"), table);
    return readPcd(folder.path("a.pcd")).data;
  };
  table.removeColumns("_");
  EXPECT_EQ(written(), (Bytes{1, 2, 11, 12}));
  table.setColumn("c", Bytes{3, 4, 13, 14}, 2);
  EXPECT_EQ(written(), (Bytes{1, 2, 3, 4, 11, 12, 13, 14}));
  table.setColumn("b", std::vector<std::int16_t>{5, 15});
  EXPECT_EQ(written(), (Bytes{1, 5, 0, 3, 4, 11, 15, 0, 13, 14}));
  const std::size_t size = table.data.size();
  table.setColumn("b", Bytes{6, 16});
  EXPECT_EQ(written(), (Bytes{1, 6, 3, 4, 11, 16, 13, 14}));
  EXPECT_EQ(table.data.size(), size);
  EXPECT_EQ(PcdColumn(table, table.find("b"))(1), 16.0);
  EXPECT_EQ(PcdColumn(table, table.find("c"))(1, 1), 14.0);
  EXPECT_EQ(table.find("_"), -1);
  for (const std::size_t count : {std::size_t(2), kMaxPcdPointSize})
    thrownMessage<InvalidParameterException>([&] {
      table.setColumn("d", Bytes{1, 2, 3}, count);
    });
  thrownMessage<InvalidParameterException>([&] { PcdColumn column(table, -1); });
  thrownMessage<InvalidParameterException>([&] { PcdColumn(table, 0).bits(0); });
}
