// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_surface_parts.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

using namespace pcl_semantic;

namespace {

using Cloud = CliqueGenerator::Cloud;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double focal = 707.0;

// Simulates a camera whose middle pixel looks ahead; depths of NaN or less than 0 are
// missing.
Cloud
seen(int width, int height, const std::function<double(double x, double y)>& depth)
{
  Cloud cloud(std::uint32_t{unsigned(width)}, std::uint32_t{unsigned(height)});
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const double x = (u - width / 2) / focal, y = (v - height / 2) / focal;
      const double z = depth(x, y);
      pcl::PointXYZRGB& point = cloud(std::size_t(u), std::size_t(v));
      point.x = point.y = point.z = kNaN;
      if (z > 0.0)
        point.getVector3fMap() = (z * Eigen::Vector3d(x, y, 1.0)).cast<float>();
    }
  return cloud;
}

cv::Mat
oneSegment(const Cloud& cloud)
{
  return cv::Mat(int(cloud.height), int(cloud.width), CV_32SC1, cv::Scalar(0));
}

void
expectAsPlain(const cv::Mat& segments, const Cloud& cloud, const DepthJumps& jumps)
{
  const SurfaceParts parts = splitAtDepthJumps(segments, cloud, jumps);
  const PlainSurfaceParts plain(segments, cloud, jumps);
  EXPECT_EQ(parts.count, plain.count());
  EXPECT_EQ(std::vector<int>(parts.numbers.begin<int>(), parts.numbers.end<int>()),
            plain.numbers());
}

// Steps of depth, holes, and slanted faces in random segments.
Cloud
roughCloud(std::mt19937& random, cv::Mat& segments)
{
  std::uniform_real_distribution<double> noise(0.0, 1.0);
  const Cloud cloud = seen(90, 60, [&](double x, double y) {
    if (noise(random) < 0.15)
      return -1.0;
    const double step = std::floor(20.0 * x) + std::floor(15.0 * y);
    return 8.0 + 0.8 * step + 9.0 * x + 0.3 * noise(random);
  });
  segments = cv::Mat(60, 90, CV_32SC1);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 90; ++u)
      segments.at<int>(v, u) = u / 23 + 4 * ((v + u / 5) / 17);
  return cloud;
}

} // namespace

TEST(DepthJumps, SplitsAsFloodingDoes)
{
  std::mt19937 random(1);
  for (int run = 0; run < 10; ++run) {
    cv::Mat segments;
    const Cloud cloud = roughCloud(random, segments);
    for (const DepthJumps& jumps :
         {DepthJumps(), DepthJumps{1.0, 0.0}, DepthJumps{0.1, 0.05}, DepthJumps{0, 0}})
      expectAsPlain(segments, cloud, jumps);
    const SurfaceParts parts = splitAtDepthJumps(segments, cloud, DepthJumps());
    EXPECT_GT(parts.count, splitAtDepthJumps(segments, cloud, {0.0, 0.0}).count);
    EXPECT_LT(parts.count, 2000);
  }
}

TEST(DepthJumps, ASlantedRoadIsOne)
{
  // A camera 1.65 m above it sees 1.4 m from row to row at 40 m.
  const Cloud road = seen(
      200, 400, [](double, double y) { return y > 1.65 / 60.0 ? 1.65 / y : -1.0; });
  EXPECT_EQ(splitAtDepthJumps(oneSegment(road), road, DepthJumps()).count, 1);
  EXPECT_GT(splitAtDepthJumps(oneSegment(road), road, {1.7, 0.1}).count, 10);
  const Cloud wall =
      seen(600, 50, [](double x, double) { return x > 2.0 / 50.0 ? 2.0 / x : -1.0; });
  EXPECT_EQ(splitAtDepthJumps(oneSegment(wall), wall, DepthJumps()).count, 1);
}

TEST(DepthJumps, APoleIsNotTheWallBehind)
{
  for (const auto& [pole, wall] : {std::pair(4.0, 5.0), {10.0, 11.0}, {20.0, 23.0}}) {
    const Cloud cloud = seen(60, 40, [&, p = pole, w = wall](double x, double) {
      return std::abs(x) < 5.5 / focal ? p : w;
    });
    const SurfaceParts parts =
        splitAtDepthJumps(oneSegment(cloud), cloud, DepthJumps());
    EXPECT_EQ(parts.count, 3) << pole; // the wall on both sides of it
    EXPECT_EQ(parts.numbers.at<int>(20, 0), 0);
    EXPECT_EQ(parts.numbers.at<int>(20, 30), 1);
    EXPECT_EQ(parts.numbers.at<int>(20, 59), 2);
  }
}

TEST(DepthJumps, AHoleDoesNotSplitWhatGoesOnBehindIt)
{
  const auto plane = [](double x, double) { return 10.0 + x; };
  Cloud cloud = seen(40, 30, plane);
  for (int v = 0; v < 30; ++v)
    for (const int u : {18, 19, 20})
      cloud(std::size_t(u), std::size_t(v)).z = kNaN;
  cv::Mat segments = oneSegment(cloud);
  EXPECT_EQ(splitAtDepthJumps(segments, cloud, DepthJumps()).count, 1);
  segments.col(19).setTo(1); // now another segment lies between
  EXPECT_EQ(splitAtDepthJumps(segments, cloud, DepthJumps()).count, 2);
}

TEST(DepthJumps, NothingWithDepthGivesNoPart)
{
  const Cloud cloud = seen(9, 7, [](double, double) { return -1.0; });
  const SurfaceParts parts = splitAtDepthJumps(oneSegment(cloud), cloud, DepthJumps());
  EXPECT_EQ(parts.count, 0);
  EXPECT_EQ(cv::countNonZero(parts.numbers != -1), 0);
  EXPECT_EQ(splitAtDepthJumps(cv::Mat(0, 0, CV_32SC1), Cloud(), DepthJumps()).count, 0);
}

TEST(DepthJumps, TheNumberOfThreadsChangesNothing)
{
  std::mt19937 random(2);
  cv::Mat segments;
  const Cloud cloud = roughCloud(random, segments);
  for (const int threads : {1, 2, 7}) {
    setNumberOfThreads(threads);
    expectAsPlain(segments, cloud, DepthJumps());
  }
  setNumberOfThreads(0);
}

TEST(DepthJumps, RefusesWhatDoesNotFit)
{
  const Cloud cloud = seen(9, 7, [](double, double) { return 1.0; });
  thrownMessage<BadInputException>(
      [&] { splitAtDepthJumps(cv::Mat::zeros(9, 7, CV_32SC1), cloud, DepthJumps()); });
  thrownMessage<BadInputException>(
      [&] { splitAtDepthJumps(cv::Mat::zeros(7, 9, CV_8UC1), cloud, DepthJumps()); });
  for (const double bad : {-1.0, double(kNaN), 1e9}) {
    expectBadParameter("passing distance", [&] { DepthJumps({bad, 0.1}).validate(); });
    expectBadParameter("near", [&] { DepthJumps({0.5, bad}).validate(); });
  }
}
