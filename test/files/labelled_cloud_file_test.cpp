// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/refused_file.h"

#include <pcl_semantic/files/cloud_file.h>

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstdlib>
#include <limits>

using namespace pcl_semantic;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// An ascii file; `fields` is "name type size count" a field, `points` a line a point.
std::string
pcdText(const std::vector<std::vector<std::string>>& fields, const std::string& points,
        int width, int height = 1)
{
  std::string text = "VERSION 0.7\n";
  const char* const keywords[] = {"FIELDS", "TYPE", "SIZE", "COUNT"};
  for (std::size_t k = 0; k < 4; ++k) {
    text += keywords[k];
    for (const std::vector<std::string>& field : fields)
      text += " " + field[k];
    text += "\n";
  }
  return text + "WIDTH " + std::to_string(width) + "\nHEIGHT " +
         std::to_string(height) + "\nVIEWPOINT 1 2 3 0.5 -0.5 0.5 0.5\nPOINTS " +
         std::to_string(width * height) + "\nDATA ascii\n" + points;
}

const std::vector<std::string> x = {"x", "F", "4", "1"}, y = {"y", "F", "4", "1"},
                               z = {"z", "F", "4", "1"},
                               label = {"label", "U", "4", "1"},
                               two_classes = {"probability", "F", "4", "2"},
                               clique = {"clique", "U", "4", "1"};

LabelledCloud
read(const std::string& text)
{
  const TemporaryFolder folder;
  return readLabelledCloud(folder.write("a.pcd", text));
}

// EXPECT that a file of one point is refused.
::testing::AssertionResult
refuses(const std::vector<std::vector<std::string>>& fields, const std::string& point,
        const std::string& part)
{
  return refusesFile("cloud.pcd", pcdText(fields, point + "\n", 1), part,
                     [](const std::string& path) { readLabelledCloud(path); });
}

// A cloud as a program makes it, without a file.
LabelledCloud
someCloud(int width, int height)
{
  LabelledCloud labelled;
  labelled.cloud->resize(std::size_t(width) * std::size_t(height));
  labelled.cloud->width = unsigned(width);
  labelled.cloud->height = unsigned(height);
  labelled.cloud->sensor_origin_ = {1.0f, -2.5f, 0.1f, 0.0f};
  labelled.has_colour = labelled.has_labels = true;
  labelled.distributions = LabelDistributions(3, width * height);
  for (std::size_t i = 0; i < labelled.cloud->size(); ++i) {
    pcl::PointXYZRGBL& point = (*labelled.cloud)[i];
    point.getVector3fMap() = Eigen::Vector3f(0.1f, -3.0f, 2e5f) * float(i);
    point.rgba = 0xFF010203u * unsigned(i);
    point.label = unsigned(i % 4);
    labelled.distributions.setLabel(Eigen::Index(i), Label(i % 4), 0.5f);
  }
  return labelled;
}

// NaN equals NaN.
void
expectSamePoints(const pcl::PointCloud<pcl::PointXYZRGBL>& a,
                 const pcl::PointCloud<pcl::PointXYZRGBL>& b)
{
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.sensor_origin_, b.sensor_origin_);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_TRUE(a[i].data[axis] == b[i].data[axis] ||
                  (std::isnan(a[i].data[axis]) && std::isnan(b[i].data[axis])));
    ASSERT_EQ(a[i].rgba, b[i].rgba);
    ASSERT_EQ(a[i].label, b[i].label);
  }
}

void
expectSameCloud(const LabelledCloud& read, const LabelledCloud& written)
{
  expectSamePoints(*read.cloud, *written.cloud);
  ASSERT_EQ(read.distributions.classes(), written.distributions.classes());
  EXPECT_TRUE(
      read.distributions.matrix().isApprox(written.distributions.matrix(), 1e-6f));
  ASSERT_EQ(read.cliques.size(), written.cliques.size());
  for (std::size_t c = 0; c < read.cliques.size(); ++c)
    EXPECT_EQ(read.cliques[c].indices, written.cliques[c].indices);
  EXPECT_EQ(read.has_colour, written.has_colour);
}

} // namespace

TEST(LabelledCloudFile, ReadsWhatItWrote)
{
  for (const auto& [width, height] :
       {std::pair(7, 5), std::pair(35, 1), std::pair(0, 0)}) {
    LabelledCloud written = someCloud(width, height);
    if (width > 0) {
      (*written.cloud)[4].y = kNaN;
      written.cliques.resize(2);
      written.cliques[0].indices = {3, 9, 30};
      written.cliques[1].indices = {0};
    }
    const TemporaryFolder folder;
    writeLabelledCloud(folder.path("a.pcd"), written);
    const LabelledCloud once = readLabelledCloud(folder.path("a.pcd"));
    EXPECT_EQ(once.cloud->is_dense, width == 0);
    if (width == 0)
      written.cloud->height = 1; // of a list of points
    expectSameCloud(once, written);
    pcl::PointCloud<pcl::PointXYZRGBL> as_pcl;
    if (width > 0) {
      ASSERT_EQ(pcl::io::loadPCDFile(folder.path("a.pcd"), as_pcl), 0);
      expectSamePoints(as_pcl, *written.cloud);
    }
    writeLabelledCloud(folder.path("b.pcd"), once);
    EXPECT_EQ(bytesOf(folder.path("b.pcd")), bytesOf(folder.path("a.pcd")));
  }
}

TEST(LabelledCloudFile, MovesThePointsOfAMapToTheCentresOfVoxels)
{
  LabelledCloud labelled =
      read("# voxel_grid 0.5 -1000.25 0 0.125\n" +
           pcdText({x, y, z}, "-1000.24 0.5 0.1\n3 -0.01 -7\nnan 1 1\n1e9 0 0\n", 4));
  const pcl::PointCloud<pcl::PointXYZRGBL>& cloud = *labelled.cloud;
  const std::vector<std::uint8_t> data = labelled.table.data;
  moveToVoxelCentres(labelled);
  // A point on a face belongs to the voxel above it.
  EXPECT_EQ(cloud[0].getVector3fMap(), Eigen::Vector3f(-1000.0f, 0.75f, -0.125f));
  EXPECT_EQ(cloud[1].getVector3fMap(), Eigen::Vector3f(3.0f, -0.25f, -7.125f));
  EXPECT_TRUE(std::isnan(cloud[2].x));
  EXPECT_EQ(cloud[2].y, 1.25f);
  EXPECT_EQ(cloud[3].x, 1e9f); // as near as single precision comes
  EXPECT_EQ(labelled.table.data, data) << "the table keeps the positions of the file";
}

// Any program may write such a comment: it is no reason to refuse its cloud.
TEST(LabelledCloudFile, PassesOverAVoxelGridThatIsNone)
{
  for (const std::string comment :
       {"", "# voxel_grid", "# voxel_grid 0.5", "# voxel_grid 0.5 0 0",
        "# voxel_grid 0 0 0 0", "# voxel_grid -0.5 0 0 0", "# voxel_grid nan 0 0 0",
        "# voxel_grid 0.5 0 inf 0", "# voxel_grid 0.5 0 0 0m",
        "# voxel_grid 1e999 0 0 0", "# voxel_grid: 0.5 0 0 0", "#voxel_grid 0.5 0 0 0",
        "# of a voxel_grid 1 0 0 0"}) {
    LabelledCloud labelled =
        read(comment + "\n" + pcdText({x, y, z}, "0.1 0.2 0.3\n", 1));
    const std::array<double, 4> none{};
    EXPECT_EQ(labelled.table.voxel_grid, none) << comment;
    moveToVoxelCentres(labelled);
    EXPECT_EQ((*labelled.cloud)[0].getVector3fMap(), Eigen::Vector3f(0.1f, 0.2f, 0.3f))
        << comment;
  }
}

TEST(LabelledCloudFile, ReadsFieldsInAnyOrderAndType)
{
  const LabelledCloud labelled = read(pcdText({clique,
                                               {"probability", "F", "8", "3"},
                                               {"z", "I", "2", "1"},
                                               {"label", "F", "4", "1"},
                                               {"y", "F", "8", "1"},
                                               {"rgb", "F", "4", "1"},
                                               x},
                                              "0  0.5 0.25 0.25  -7 1 0.125 0 1.5\n"
                                              "4294967294  0 0 0  8 0 1e-300 0 nan\n"
                                              "7  0.15 0.7 0.1  9 2.0 5 0 3\n",
                                              3));
  ASSERT_EQ(labelled.cloud->size(), 3u);
  const pcl::PointCloud<pcl::PointXYZRGBL>& cloud = *labelled.cloud;
  EXPECT_EQ(cloud[0].getVector3fMap(), Eigen::Vector3f(1.5f, 0.125f, -7.0f));
  EXPECT_TRUE(std::isnan(cloud[1].x));
  EXPECT_EQ(cloud[1].y, 0.0f);
  EXPECT_FALSE(cloud.is_dense);
  EXPECT_EQ(cloud[0].label, 1u);
  EXPECT_EQ(cloud[1].label, 0u);
  EXPECT_EQ(cloud[2].label, 2u);
  EXPECT_TRUE(labelled.has_colour);
  EXPECT_NEAR(labelled.distributions.matrix()(1, 2), 0.7f / 0.95f, 1e-6);
  EXPECT_EQ(labelled.distributions.matrix().col(1).sum(), 0.0f);
  ASSERT_EQ(labelled.cliques.size(), 1u); // the other's only point is not finite
  EXPECT_EQ(labelled.cliques[0].indices, pcl::Indices{2});
  EXPECT_EQ(cloud.sensor_origin_, Eigen::Vector4f(1, 2, 3, 0));
  EXPECT_TRUE(
      cloud.sensor_orientation_.isApprox(Eigen::Quaternionf(0.5f, -0.5f, 0.5f, 0.5f)));
}

TEST(LabelledCloudFile, BothPackingsOfColourAreRead)
{
  const TemporaryFolder folder;
  pcl::PointCloud<pcl::PointXYZRGB> packed;
  pcl::PointCloud<pcl::PointXYZRGBA> plain;
  packed.push_back({1.0f, 2.0f, 3.0f, 10, 20, 30});
  plain.push_back({1.0f, 2.0f, 3.0f, 10, 20, 30, 40});
  pcl::PCLPointCloud2 message;
  pcl::toPCLPointCloud2(packed, message);
  pcl::PCDWriter().writeBinary(folder.path("a.pcd"), message); // a float
  pcl::io::savePCDFileASCII(folder.path("b.pcd"), packed);     // the same as U
  pcl::io::savePCDFileBinary(folder.path("c.pcd"), plain);
  for (const char* const name : {"a.pcd", "b.pcd", "c.pcd"}) {
    const LabelledCloud labelled = readLabelledCloud(folder.path(name));
    ASSERT_EQ(labelled.cloud->size(), 1u);
    const pcl::PointXYZRGBL& point = (*labelled.cloud)[0];
    EXPECT_EQ(point.r, 10) << name;
    EXPECT_EQ(point.g, 20) << name;
    EXPECT_EQ(point.b, 30) << name;
    EXPECT_TRUE(labelled.has_colour);
    EXPECT_FALSE(labelled.has_labels);
    EXPECT_EQ(point.label, kUnlabelled);
  }
}

TEST(LabelledCloudFile, LabelsWithoutProbabilitiesAndTheOtherWayRound)
{
  const LabelledCloud hard = read(pcdText({x, y, z, label}, "1 2 3 255\n1 2 3 0\n", 2));
  EXPECT_EQ(hard.distributions.classes(), 0);
  EXPECT_EQ((*hard.cloud)[0].label, 255u);
  EXPECT_TRUE(hard.has_labels);
  EXPECT_FALSE(hard.has_colour);

  const LabelledCloud soft =
      read(pcdText({x, y, z, two_classes}, "1 2 3 .2 .8\n1 2 3 0 0\n", 2));
  EXPECT_EQ((*soft.cloud)[0].label, 2u);
  EXPECT_EQ((*soft.cloud)[1].label, kUnlabelled);
  EXPECT_TRUE(soft.has_labels);
}

TEST(LabelledCloudFile, OtherFieldsSurvive)
{
  const TemporaryFolder folder;
  const std::string text =
      pcdText({{"time", "F", "8", "1"},
               {"label", "U", "1", "1"},
               x,
               {"y", "F", "8", "1"},
               z,
               {"histogram", "U", "2", "3"},
               clique},
              "0.1 1 1 0.123456789012 3 7 8 9 5\n0.2 2 4 5 6 10 11 12 0\n", 1, 2);
  LabelledCloud labelled = readLabelledCloud(folder.write("a.pcd", text));
  (*labelled.cloud)[0].label = 2;
  labelled.distributions = LabelDistributions(2, 2);
  labelled.distributions.setLabel(1, 1, 0.75f);
  writeLabelledCloud(folder.path("b.pcd"), labelled);

  const PcdTable table = readPcd(folder.path("b.pcd"));
  std::string names;
  for (const pcl::PCLPointField& field : table.fields)
    names += field.name + " ";
  EXPECT_EQ(names, "time label x y z histogram clique probability ");
  EXPECT_EQ(table.height, 2u);
  EXPECT_EQ(table.viewpoint, labelled.table.viewpoint);
  EXPECT_EQ(PcdColumn(table, 0)(1), 0.2);
  EXPECT_EQ(PcdColumn(table, 1)(0), 2.0);
  EXPECT_EQ(PcdColumn(table, 1)(1), 2.0);
  EXPECT_EQ(PcdColumn(table, 3)(0), 0.123456789012);
  EXPECT_EQ(PcdColumn(table, 5)(0, 2), 9.0);
  EXPECT_EQ(PcdColumn(table, 6)(0), 5.0); // keeps its number
  EXPECT_EQ(PcdColumn(table, 7)(1, 0), 0.75);
}

// As a program makes one: its positions are doubles only with the origin.
TEST(LabelledCloudFile, ACloudWithoutTableKeepsItsOrigin)
{
  const TemporaryFolder folder;
  const Eigen::Vector3d origin(691000.0, 5335000.0, 512.0);
  LabelledCloud cloud;
  for (int i = 0; i < 100; ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() << 12.4f + 0.1f * float(i), 65.2f, 0.5f;
    point.label = 1;
    cloud.cloud->push_back(point);
  }
  cloud.origin = origin;
  writeLabelledCloud(folder.path("a.pcd"), cloud);
  const LabelledCloud read = readLabelledCloud(folder.path("a.pcd"));
  const CloudPositions positions(read);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_LT(
        (positions(i) - origin - (*cloud.cloud)[i].getVector3fMap().cast<double>())
            .norm(),
        1e-6);
  cloud.origin.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writeLabelledCloud(folder.path("b.pcd"), cloud),
               InvalidParameterException);
}

TEST(LabelledCloudFile, NewCliquesTakeThePlaceOfOldOnes)
{
  const TemporaryFolder folder;
  LabelledCloud labelled = readLabelledCloud(
      folder.write("a.pcd", pcdText({x, clique, y, z, label},
                                    "1 9 2 3 0\n1 9 2 3 0\n1 4 2 3 0\n", 3)));
  ASSERT_EQ(labelled.cliques.size(), 2u);
  EXPECT_EQ(labelled.cliques[0].indices, pcl::Indices{2}); // number 4 before 9
  labelled.cliques[0].indices = {1};
  labelled.cliques[1].indices = {2};
  writeLabelledCloud(folder.path("b.pcd"), labelled);
  const PcdTable table = readPcd(folder.path("b.pcd"));
  const PcdColumn column(table, 1);
  EXPECT_EQ(column.field().name, "clique");
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(column(i), double(i)); // 0 is none
}

TEST(LabelledCloudFile, MissingOrUnfitFields)
{
  EXPECT_TRUE(refuses({x, y, label}, "1 2 3", "no field 'z'"));
  EXPECT_TRUE(refuses({y, z}, "1 2", "no field 'x'"));
  EXPECT_TRUE(refuses({{"x", "F", "4", "2"}, y, z}, "1 1 2 3", "'x' has COUNT 2"));
  EXPECT_TRUE(
      refuses({x, y, z, {"label", "U", "4", "2"}}, "1 2 3 4 5", "'label' has COUNT 2"));
  EXPECT_TRUE(refuses({x, y, z, {"rgb", "U", "4", "1"}, {"rgba", "U", "4", "1"}},
                      "1 2 3 4 5", "both 'rgb' and 'rgba'"));
  EXPECT_TRUE(refuses({x, y, z, {"rgb", "F", "8", "1"}}, "1 2 3 4", "has 8 bytes"));
  std::string values = "1 2 3";
  for (int i = 0; i < 256; ++i)
    values += " 0";
  EXPECT_TRUE(
      refuses({x, y, z, {"probability", "F", "4", "256"}}, values, "COUNT 256"));
  EXPECT_TRUE(refuses({x, y, z, x}, "1 2 3 4", ""));
}

TEST(LabelledCloudFile, ValuesThatCannotBe)
{
  const auto refuses_value = [](const std::vector<std::string>& field,
                                const std::string& value, const std::string& part) {
    return refuses({x, y, z, field}, "1 2 3 " + value, part);
  };
  for (const char* const values : {"nan 1", "-0.1 1", "inf 0", "0 -inf"})
    EXPECT_TRUE(refuses_value(two_classes, values, "'probability' of point 0 is "));
  EXPECT_TRUE(refuses_value(two_classes, "0.4 0.4", "sums to 0.8"));
  EXPECT_TRUE(refuses_value(two_classes, "100 100", "sums to 200"));
  for (const char* const value : {"256", "-1", "1.5", "nan", "inf", "1e300"})
    EXPECT_TRUE(
        refuses_value({"label", "F", "8", "1"}, value, "'label' of point 0 is "))
        << value;
  for (const char* const value : {"-1", "0.5", "nan", "4294967296"})
    EXPECT_TRUE(
        refuses_value({"clique", "F", "8", "1"}, value, "'clique' of point 0 is "))
        << value;
  EXPECT_TRUE(refusesFile("a.pcd",
                          pcdText({x, y, z, label}, "1 2 3 4\n1 2 3 4\n1 2 3 400\n", 3),
                          "a.pcd: field 'label' of point 2 is 400",
                          [](const std::string& path) { readLabelledCloud(path); }));
  EXPECT_TRUE(refuses({x, y, z, label, two_classes}, "1 2 3 3 1 0",
                      "'label' of point 0 is 3, expected a whole number from 0 to 2"));
  EXPECT_TRUE(
      refuses({x, {"y", "F", "8", "1"}, z}, "1 -1e39 3", "'y' of point 0 is -1e+39"));
}

TEST(LabelledCloudFile, RefusesToWriteWhatDoesNotFit)
{
  const TemporaryFolder folder;
  const auto message = [&](const LabelledCloud& labelled) {
    return thrownMessage<InvalidParameterException>(
        [&] { writeLabelledCloud(folder.path("a.pcd"), labelled); });
  };
  LabelledCloud labelled;
  for (const int classes : {1, 2}) {
    labelled = read(pcdText({x, y, z, label}, "1 2 3 1\n1 2 3 0\n", 2));
    labelled.distributions = LabelDistributions(classes, 3);
    EXPECT_TRUE(holds(message(labelled),
                      "the cloud has 2 points, its table 2, its distributions 3"));
  }
  labelled = someCloud(4, 3);
  labelled.cliques.resize(2);
  labelled.cliques[0].indices = {1, 2};
  labelled.cliques[1].indices = {2, 3};
  EXPECT_TRUE(holds(message(labelled), "point 2 is in cliques 0 and 1"));
  labelled.cliques[1].indices = {12};
  EXPECT_TRUE(holds(message(labelled), "point 12 of 12"));
  labelled = read(pcdText({x, y, z}, "1 2 3\n", 1));
  labelled.cloud->push_back((*labelled.cloud)[0]);
  EXPECT_TRUE(holds(message(labelled), "its table 1"));
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(LabelledCloudFile, ARealCloudIsReadAsPclReadsIt)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "PCL_SEMANTIC_DATA is not set";
  const std::string path = std::string(data) + "/clouds/mosd_learn0.pcd";
  const LabelledCloud labelled = readLabelledCloud(path);
  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(path, cloud), 0);
  EXPECT_EQ(labelled.cloud->width, 640u);
  EXPECT_EQ(labelled.cloud->height, 480u);
  expectSamePoints(*labelled.cloud, cloud);
}
