// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/local_origin.h>
#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/filters/label_voxel_grid.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

#include <pcl/common/io.h>
#include <pcl/conversions.h>

#include <functional>

namespace pcl_semantic {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;

// A floor of points 5 cm apart.
Cloud::Ptr
floorAt(double x, double y)
{
  Cloud::Ptr cloud(new Cloud);
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      pcl::PointXYZRGBL point;
      point.getVector3fMap() << float(x + 0.05 * i), float(y + 0.05 * j), 1.0f;
      point.label = 1;
      cloud->push_back(point);
    }
  return cloud;
}

// Its positions as doubles of the same values.
pcl::PCLPointCloud2
widened(const Cloud& cloud)
{
  PcdTable table;
  table.width = pcl::uindex_t(cloud.size());
  table.height = 1;
  const char* const names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const pcl::PointXYZRGBL& point : cloud)
      values.push_back(point.data[axis]);
    table.setColumn(names[axis], values);
  }
  table.setColumn("label", std::vector<std::uint32_t>(cloud.size(), 1));
  return table;
}

std::string
printedBy(const std::function<void()>& action)
{
  testing::internal::CaptureStderr();
  action();
  return testing::internal::GetCapturedStderr();
}

void
expectOneLine(const std::string& printed, const std::string& filter)
{
  EXPECT_EQ(std::count(printed.begin(), printed.end(), '\n'), 1) << printed;
  EXPECT_NE(printed.find("[pcl_semantic::" + filter + "] cloud: single precision"),
            std::string::npos)
      << printed;
}

void
thin(const pcl::PCLPointCloud2& blob)
{
  LabelVoxelGrid grid;
  grid.setLeafSize(0.2);
  grid.setInputCloud(std::make_shared<pcl::PCLPointCloud2>(blob));
  pcl::PCLPointCloud2 output;
  grid.filter(output);
}

void
thin(const Cloud& cloud)
{
  pcl::PCLPointCloud2 blob;
  pcl::toPCLPointCloud2(cloud, blob);
  thin(blob);
}

void
refine(const Cloud::Ptr& cloud, const Eigen::Vector3d* origin = nullptr)
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setLabelConfidence(0.8, 4);
  if (origin)
    crf.setOrigin(*origin);
  crf.setInputCloud(cloud);
  Cloud output;
  crf.filter(output);
}

} // namespace

TEST(PositionSteps, FiltersWarnOfThem)
{
  const Cloud::Ptr here = floorAt(17.0, 35.0), there = floorAt(691017.0, 5336035.0);
  CliqueGenerator::Cloud colours_here, colours_there;
  pcl::copyPointCloud(*here, colours_here);
  pcl::copyPointCloud(*there, colours_there);
  expectOneLine(printedBy([&] { refine(there); }), "SemanticCRF");
  expectOneLine(printedBy([&] { thin(*there); }), "LabelVoxelGrid");
  expectOneLine(printedBy([&] { thin(widened(*there)); }), "LabelVoxelGrid");
  expectOneLine(printedBy([&] { CubeCliques(0.2).generate(colours_there); }),
                "CubeCliques");
  expectOneLine(printedBy([&] { SupervoxelCliques().generate(colours_there); }),
                "SupervoxelCliques");
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  EXPECT_EQ(printedBy([&] {
              refine(here);
              refine(there, &zero); // its caller knows
              thin(*here);
              thin(widened(*here));
              CubeCliques(0.2).generate(colours_here);
              SupervoxelCliques().generate(colours_here);
            }),
            "");
}

TEST(PositionSteps, RemaindersAreWhatSinglePrecisionLeavesOut)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix3Xd positions(3, 5);
  positions << 500000.0001, 500001.0002, 520000.0003, nan, 500002.0, //
      5400000.0004, 5400001.0005, 5420000.0006, 1.0, 5400002.0,      //
      300.0007, 301.0008, 302.0009, 1.0, 302.0;
  const Eigen::Vector3d origin = localOrigin(positions);
  const Eigen::Matrix3Xf relative = relativeTo(origin, positions);
  const Eigen::Matrix3Xf remainders = remaindersOf(origin, positions, relative);
  ASSERT_EQ(remainders.cols(), 5);
  for (const int i : {0, 1, 2, 4}) {
    const Eigen::Vector3d sum =
        origin + relative.col(i).cast<double>() + remainders.col(i).cast<double>();
    EXPECT_LT((sum - positions.col(i)).cwiseAbs().maxCoeff(), 2e-9); // [m]
  }
  EXPECT_GT(remainders.col(2).cwiseAbs().maxCoeff(), 1e-5f);
  EXPECT_TRUE(remainders.col(3).isZero(0.0f));
  const Eigen::Matrix3Xd narrow = positions.leftCols(2);
  EXPECT_EQ(remaindersOf(origin, narrow, relativeTo(origin, narrow)).size(), 0);
}

TEST(PositionSteps, RemaindersAreOfOneCloud)
{
  const Cloud::Ptr cloud(new Cloud(20, 1));
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].x = 0.1f * float(i + 1);
    (*cloud)[i].label = 1;
  }
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setLabelConfidence(0.8, 4);
  crf.setInputCloud(cloud);
  crf.setRemainders(Eigen::Matrix3Xf::Zero(3, 19));
  Cloud refined;
  EXPECT_THROW(crf.filter(refined), InvalidParameterException);
  EXPECT_NO_THROW(crf.filter(refined));
  EXPECT_THROW(crf.setRemainders(Eigen::Matrix3Xf::Constant(3, 20, NAN)),
               InvalidParameterException);
}

TEST(PositionSteps, PointsWithoutAReturnStayWithoutOneWhenAnOriginIsTakenOff)
{
  Eigen::Matrix3Xd positions(3, 5);
  positions << 691017.5, 0.0, 691018.25, 0.0, 691019.1, //
      5336035.5, 0.0, 5336036.0, 0.0, 5336037.0,        //
      300.0, 0.0, 301.0, 0.0, 302.0;
  const Eigen::Vector3d origin = localOrigin(positions);
  EXPECT_GT(origin.x(), 6e5);
  Eigen::Matrix3Xf relative = relativeTo(origin, positions);
  EXPECT_TRUE(relative.col(1).isZero(0.0f));
  EXPECT_TRUE(relative.col(3).isZero(0.0f));
  EXPECT_NEAR(relative(0, 2), 691018.25 - origin.x(), 1e-4);
  EXPECT_FALSE(areSingle(positions));
  EXPECT_TRUE(areSingle(positions.cast<float>().cast<double>()));
  positions.col(3) = positions.col(4); // one alone may be real
  relative = relativeTo(origin, positions);
  EXPECT_NEAR(relative(0, 1), -origin.x(), 0.1);
}

} // namespace pcl_semantic
