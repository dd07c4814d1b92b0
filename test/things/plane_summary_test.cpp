// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/plane_summary.h>

#include "support/named_classes.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/plane_file.h>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace pcl_semantic {

namespace {

// The signed area of a ring, seen against a normal.
double
areaOf(const PlaneRing& ring, const Eigen::Vector3d& normal)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i)
    sum += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
  return 0.5 * sum.dot(normal);
}

// A grid of points 2 m x 1 m in a tilted plane, with a hole of 0.6 m x 0.4 m.
struct Board {
  Eigen::Vector3d normal = Eigen::Vector3d(0.48, 0.6, 0.64);
  std::vector<Eigen::Vector3d> points;
  ExtractedPlane plane;

  Board()
  {
    const Eigen::Vector3d u = normal.cross(Eigen::Vector3d::UnitX()).normalized();
    const Eigen::Vector3d v = normal.cross(u);
    for (double x = 0.01; x < 2.0; x += 0.02)
      for (double y = 0.01; y < 1.0; y += 0.02)
        if (x < 0.7 || x > 1.3 || y < 0.3 || y > 0.7)
          points.push_back(3.0 * normal + x * u + y * v);
    plane.normal = normal;
    plane.offset = -3.0;
    for (std::size_t i = 0; i < points.size(); ++i)
      plane.indices.push_back(pcl::index_t(i));
  }

  PlaneSummary
  summary() const
  {
    return summarizePlane(
        plane, [&](std::size_t i) { return points[i]; },
        [](std::size_t i) { return Label(i % 5 == 0   ? 1
                                         : i % 5 == 1 ? 0
                                                      : 2); }, 0.05);
  }
};

} // namespace

TEST(PlaneSummary, HasTheOutlineAndItsHole)
{
  const Board board;
  const PlaneSummary summary = board.summary();
  EXPECT_EQ(summary.label, 2);
  EXPECT_EQ(summary.points, board.points.size());
  EXPECT_NEAR(summary.area, 2.0 - 0.24, 0.15); // squares of 0.05 m at the borders
  ASSERT_EQ(summary.polygons.size(), 1u);
  const PlanePolygon& polygon = summary.polygons[0];
  EXPECT_NEAR(areaOf(polygon.outer, board.normal), 2.0, 0.2);
  ASSERT_EQ(polygon.holes.size(), 1u);
  EXPECT_NEAR(areaOf(polygon.holes[0], board.normal), -0.24, 0.09);
  for (const Eigen::Vector3d& corner : polygon.outer)
    EXPECT_NEAR(board.normal.dot(corner), 3.0, 1e-9);
}

TEST(PlaneSummary, PartsArePolygonsAndUnlabelledPointsDoNotVote)
{
  ExtractedPlane plane;
  plane.normal = Eigen::Vector3d::UnitZ();
  plane.indices = {0, 1};
  const auto position = [](std::size_t i) { return Eigen::Vector3d(double(i), 0, 0); };
  const PlaneSummary summary = summarizePlane(
      plane, position, [](std::size_t) { return kUnlabelled; }, 0.1);
  EXPECT_EQ(summary.label, kUnlabelled);
  EXPECT_EQ(summary.polygons.size(), 2u);
  EXPECT_NEAR(summary.area, 0.02, 1e-12);
  EXPECT_THROW(summarizePlane(
                   plane, position, [](std::size_t) { return kUnlabelled; }, 0.0),
               InvalidParameterException);
  EXPECT_THROW(summarizePlane(
                   plane, [](std::size_t) { return Eigen::Vector3d(1e12, 0, 0); },
                   [](std::size_t) { return kUnlabelled; }, 0.1),
               BadInputException);
}

TEST(PlaneFile, ReadsWhatItWrites)
{
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/planes.json";
  const LabelSet label_set(namedClasses({"floor", "wall"}));
  PlaneSummary plane = Board().summary();
  plane.id = 7;
  writePlanes(path, {plane}, label_set);
  const std::vector<PlaneSummary> read = readPlanes(path, label_set);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].id, 7u);
  EXPECT_EQ(read[0].label, plane.label);
  EXPECT_EQ(read[0].points, plane.points);
  EXPECT_EQ(read[0].normal, plane.normal);
  EXPECT_EQ(read[0].offset, plane.offset);
  EXPECT_EQ(read[0].area, plane.area);
  ASSERT_EQ(read[0].polygons.size(), 1u);
  EXPECT_EQ(read[0].polygons[0].outer, plane.polygons[0].outer);
  EXPECT_EQ(read[0].polygons[0].holes, plane.polygons[0].holes);
}

TEST(PlaneFile, RefusesBadValuesInOneLine)
{
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/planes.json";
  const std::string good =
      R"({"id": 1, "label": 1, "points": 3, "normal": [0, 0, 1], "offset": -1,)"
      R"( "area": 1, "polygons": [{"outer": [[0,0,1],[1,0,1],[1,1,1]], "holes": []}]})";
  const auto messageOf = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    writeTextFile(path, "{\"planes\": [" + text + "]}");
    return thrownMessage<BadInputException>(
        [&] { readPlanes(path, LabelSet(namedClasses({"floor"}))); });
  };
  EXPECT_EQ(messageOf("\"label\": 1", "\"label\": 2"),
            path + ": planes[0].label: got 2, expected 0 to 1");
  EXPECT_EQ(messageOf("[0, 0, 1]", "[0, 0, 2]"),
            path +
                ": planes[0].normal: got a list of 3, expected a vector of length 1");
  EXPECT_EQ(messageOf("[1,0,1]", "[1,0]"),
            path + ": planes[0].polygons[0].outer[1]: got a list of 2, expected 3 "
                   "numbers");
  EXPECT_EQ(messageOf(",[1,1,1]", ""), path + ": planes[0].polygons[0].outer: got a "
                                              "list of 2, expected three or more "
                                              "corners");
  writeTextFile(path, "{\"planes\": [" + good + "," + good + "]}");
  EXPECT_EQ(thrownMessage<BadInputException>([&] { readPlanes(path, LabelSet()); }),
            path + ": planes[1].id: got 1, which an earlier one has");
}

} // namespace pcl_semantic
