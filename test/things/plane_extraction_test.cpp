// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/plane_extraction.h>

#include "support/thrown_message.h"
#include "things/surface_cells.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/things/plane_cliques.h>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

namespace pcl_semantic {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZL>;

constexpr double kDegree = M_PI / 180.0;

// A rectangle with points at random places; its label is its number, from 1.
struct Rectangle {
  Eigen::Vector3d corner, u, v; // corner and edges [m]

  Eigen::Vector3d
  normal() const
  {
    return u.cross(v).normalized();
  }
};

// A room with a floor, two walls, a table and two shelves of a rack [m].
std::vector<Rectangle>
room()
{
  return {{{0, 0, 0}, {5, 0, 0}, {0, 4, 0}},
          {{0, 4, 0}, {5, 0, 0}, {0, 0, 2.5}},
          {{5, 0, 0}, {0, 4, 0}, {0, 0, 2.5}},
          {{1, 1, 0.75}, {1.6, 0.2, 0}, {-0.1, 0.8, 0}},
          {{3, 3.4, 0.6}, {1.5, 0, 0}, {0, 0.5, 0}},
          {{3, 3.4, 1.2}, {1.5, 0, 0}, {0, 0.5, 0}}};
}

Cloud::Ptr
pointsOn(const std::vector<Rectangle>& rectangles, double noise,
         double per_area = 900.0)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  Cloud::Ptr cloud(new Cloud);
  for (std::size_t r = 0; r < rectangles.size(); ++r) {
    const Rectangle& each = rectangles[r];
    const auto count = int(each.u.cross(each.v).norm() * per_area);
    for (int i = 0; i < count; ++i) {
      const double a = uniform(random), b = uniform(random);
      const Eigen::Vector3d place = each.corner + a * each.u + b * each.v +
                                    noise * normal(random) * each.normal();
      pcl::PointXYZL point;
      point.getVector3fMap() = place.cast<float>();
      point.label = std::uint32_t(r) + 1;
      cloud->push_back(point);
    }
  }
  return cloud;
}

std::vector<ExtractedPlane>
planesOf(const Cloud::Ptr& cloud, const PlaneParameters& parameters = PlaneParameters())
{
  PlaneExtraction<pcl::PointXYZL> extraction;
  extraction.setParameters(parameters);
  extraction.setInputCloud(cloud);
  return extraction.extract();
}

// Intersection over union with the points of a rectangle.
double
overlap(const ExtractedPlane& plane, std::uint32_t label, const Cloud& cloud)
{
  std::size_t both = 0, any = plane.indices.size();
  for (const pcl::index_t i : plane.indices)
    both += cloud[std::size_t(i)].label == label;
  for (const pcl::PointXYZL& point : cloud)
    any += point.label == label;
  return double(both) / double(any - both);
}

void
expectRoom(const Cloud::Ptr& cloud, double least, double angle, double distance)
{
  const std::vector<ExtractedPlane> planes = planesOf(cloud);
  EXPECT_EQ(planes.size(), room().size());
  for (std::uint32_t r = 0; r < room().size(); ++r) {
    const auto best = std::max_element(
        planes.begin(), planes.end(), [&](const auto& a, const auto& b) {
          return overlap(a, r + 1, *cloud) < overlap(b, r + 1, *cloud);
        });
    ASSERT_NE(best, planes.end());
    const Rectangle truth = room()[r];
    EXPECT_GT(overlap(*best, r + 1, *cloud), least) << r;
    EXPECT_GT(std::abs(best->normal.dot(truth.normal())), std::cos(angle)) << r;
    const Eigen::Vector3d middle = truth.corner + 0.5 * (truth.u + truth.v);
    EXPECT_LT(std::abs(best->normal.dot(middle) + best->offset), distance) << r;
  }
}

Cloud::Ptr
shuffled(const Cloud& cloud, std::vector<std::size_t>& order)
{
  order.resize(cloud.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  Cloud::Ptr result(new Cloud);
  for (const std::size_t i : order)
    result->push_back(cloud[i]);
  return result;
}

std::vector<Eigen::Vector3d>
positionsOf(const Cloud& cloud)
{
  std::vector<Eigen::Vector3d> positions;
  for (const pcl::PointXYZL& point : cloud)
    positions.push_back(point.getVector3fMap().cast<double>());
  return positions;
}

} // namespace

TEST(FitPlane, IsThatOfAnEigenvalueSolver)
{
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix3d axes = Eigen::Quaterniond(normal(random), normal(random),
                                                    normal(random), normal(random))
                                     .normalized()
                                     .toRotationMatrix();
    const Eigen::Vector3d sizes(2.0, 1.0, 0.01 + 0.002 * trial);
    const Eigen::Vector3d centre(100.0, -50.0, 7.0);
    PlaneMoments moments(centre);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d p(normal(random), normal(random), normal(random));
      points.push_back(centre + axes * sizes.cwiseProduct(p));
      moments.add(points.back());
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points)
      mean += p / double(points.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : points)
      covariance += (p - mean) * (p - mean).transpose() / double(points.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const FittedPlane plane = fitPlane(moments);
    EXPECT_LT((plane.centre - mean).norm(), 1e-12);
    EXPECT_NEAR(plane.curvature, solver.eigenvalues()[0] / covariance.trace(), 1e-10);
    const bool is_flat = solver.eigenvalues()[0] <= 0.25 * solver.eigenvalues()[1] &&
                         solver.eigenvalues()[1] >= solver.eigenvalues()[2] / 16.0;
    EXPECT_EQ(plane.is_surface, is_flat);
    EXPECT_NEAR(plane.deviation, std::sqrt(solver.eigenvalues()[0]), 1e-9);
    if (is_flat) {
      EXPECT_GT(std::abs(plane.normal.dot(solver.eigenvectors().col(0))), 1.0 - 1e-9);
      EXPECT_GT(plane.normal.maxCoeff(), -plane.normal.minCoeff());
    }
  }
}

TEST(FitPlane, HasNoNormalOfLinesAndPoints)
{
  PlaneMoments moments;
  EXPECT_TRUE(fitPlane(moments).normal.isZero());
  for (int i = 0; i < 20; ++i) {
    moments.add({double(i), 2.0 * i, -0.5 * i});
    EXPECT_TRUE(fitPlane(moments).normal.isZero()) << i;
  }
}

TEST(SurfaceCells, NeighboursAreThoseWithinTheRadius)
{
  const Cloud::Ptr cloud = pointsOn(room(), 0.05, 100.0);
  const double radius = 0.2;
  const SurfaceCells cells(positionsOf(*cloud), radius);
  ASSERT_GT(cells.size(), 500u);
  std::size_t points = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    points += cells[c].last - cells[c].first;
    std::set<std::size_t> expected, found;
    for (std::size_t other = 0; other < cells.size(); ++other)
      if (other != c && (cells[other].mean - cells[c].mean).norm() <= radius)
        expected.insert(other);
    cells.forEachNeighbour(c, [&](std::size_t other) { found.insert(other); });
    EXPECT_EQ(found, expected);
  }
  EXPECT_EQ(points, cloud->size());
}

TEST(PlaneExtraction, FindsThePlanesOfARoom)
{
  expectRoom(pointsOn(room(), 0.0), 0.9, 1.0 * kDegree, 0.02);
}

TEST(PlaneExtraction, FindsThemWithNoise)
{
  expectRoom(pointsOn(room(), 0.02), 0.85, 1.0 * kDegree, 0.02);
}

TEST(PlaneExtraction, DependsNeitherOnTheOrderNorOnTheThreads)
{
  const Cloud::Ptr cloud = pointsOn(room(), 0.01);
  setNumberOfThreads(1);
  const std::vector<ExtractedPlane> expected = planesOf(cloud);
  setNumberOfThreads(4);
  std::vector<std::size_t> order;
  const std::vector<ExtractedPlane> found = planesOf(shuffled(*cloud, order));
  setNumberOfThreads(0);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t p = 0; p < found.size(); ++p) {
    EXPECT_EQ(found[p].normal, expected[p].normal);
    EXPECT_EQ(found[p].offset, expected[p].offset);
    pcl::Indices indices;
    for (const pcl::index_t i : found[p].indices)
      indices.push_back(pcl::index_t(order[std::size_t(i)]));
    std::sort(indices.begin(), indices.end());
    EXPECT_EQ(indices, expected[p].indices);
  }
}

TEST(PlaneExtraction, MergesCoplanarPartsWithASmallGap)
{
  const Rectangle left{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  const auto planesWithGap = [&](double gap) {
    const Rectangle right{{1 + gap, 0, 1}, {1, 0, 0}, {0, 1, 0}};
    return planesOf(pointsOn({left, right}, 0.0)).size();
  };
  EXPECT_EQ(planesWithGap(0.5), 1u);
  EXPECT_EQ(planesWithGap(2.0), 2u);
  const Rectangle step{{1.2, 0, 1.2}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(planesOf(pointsOn({left, step}, 0.0)).size(), 2u);
}

TEST(PlaneExtraction, FindsNoneInWhatIsNotFlat)
{
  EXPECT_TRUE(planesOf(Cloud::Ptr(new Cloud)).empty());
  Cloud::Ptr line(new Cloud), ball(new Cloud);
  std::mt19937 random(3);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  for (int i = 0; i < 3000; ++i) {
    pcl::PointXYZL point;
    point.getVector3fMap() = Eigen::Vector3f(0.01f * float(i), 0.0f, 0.0f);
    line->push_back(point);
    const Eigen::Vector3f direction(normal(random), normal(random), normal(random));
    point.getVector3fMap() = 0.3f * direction.normalized();
    ball->push_back(point);
  }
  EXPECT_TRUE(planesOf(line).empty());
  EXPECT_TRUE(planesOf(ball).empty());
}

TEST(PlaneExtraction, SkipsPointsWithoutAPlaceAndOtherIndices)
{
  const Cloud::Ptr cloud = pointsOn(
      {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 3}, {1, 0, 0}, {0, 1, 0}}}, 0);
  const std::size_t half = cloud->size() / 2;
  (*cloud)[7].x = std::numeric_limits<float>::quiet_NaN();
  PlaneExtraction<pcl::PointXYZL> extraction;
  extraction.setInputCloud(cloud);
  pcl::IndicesPtr indices(new pcl::Indices(half));
  std::iota(indices->begin(), indices->end(), 0);
  extraction.setIndices(indices);
  std::vector<pcl::ModelCoefficients> coefficients;
  std::vector<pcl::PointIndices> inliers;
  extraction.segment(coefficients, inliers);
  ASSERT_EQ(inliers.size(), 1u);
  EXPECT_EQ(inliers[0].indices.size(), half - 1);
  ASSERT_EQ(coefficients.size(), 1u);
  const std::vector<float> expected{0.0f, 0.0f, 1.0f, -1.0f};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(coefficients[0].values[i], expected[i], 1e-5f);
}

TEST(PlaneExtraction, RefusesParametersAndExtents)
{
  PlaneExtraction<pcl::PointXYZL> extraction;
  EXPECT_THROW(extraction.extract(), InvalidParameterException); // no cloud
  for (const double bad : {-1.0, HUGE_VAL, std::nan("")}) {
    PlaneParameters parameters;
    parameters.radius = bad;
    EXPECT_THROW(extraction.setParameters(parameters), InvalidParameterException);
  }
  Cloud::Ptr line(new Cloud);
  for (int i = 0; i < 800000; ++i) {
    line->emplace_back();
    line->back().getVector3fMap() = Eigen::Vector3f(float(i), 0.0f, 0.0f);
  }
  PlaneParameters parameters;
  parameters.radius = 0.1;
  EXPECT_TRUE(
      holds(thrownMessage<BadInputException>([&] { planesOf(line, parameters); }),
            "planes extend over 2399999 cubes, expected less than 2097148"));
}

TEST(PlaneExtraction, ADistantPointDoesNotMatter)
{
  const Cloud::Ptr cloud = pointsOn(room(), 0.0);
  const std::vector<ExtractedPlane> expected = planesOf(cloud);
  cloud->emplace_back();
  cloud->back().getVector3fMap() = Eigen::Vector3f(-3e6f, 2e7f, 1e6f);
  const std::vector<ExtractedPlane> found = planesOf(cloud);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t p = 0; p < found.size(); ++p) {
    EXPECT_EQ(found[p].normal, expected[p].normal);
    EXPECT_EQ(found[p].indices, expected[p].indices);
  }
}

TEST(PlaneCliques, AreThePiecesOfPlanes)
{
  const Cloud::Ptr labelled = pointsOn({{{0, 0, 1}, {1.5, 0, 0}, {0, 0.8, 0}}}, 0.0);
  PlaneCliques::Cloud cloud;
  for (const pcl::PointXYZL& point : *labelled) {
    cloud.emplace_back();
    cloud.back().getVector3fMap() = point.getVector3fMap();
  }
  EXPECT_EQ(PlaneCliques(HUGE_VAL).generate(cloud).size(), 1u);
  const std::vector<pcl::PointIndices> pieces = PlaneCliques(1.0).generate(cloud);
  ASSERT_EQ(pieces.size(), 2u);
  for (const pcl::PointIndices& piece : pieces)
    for (const pcl::index_t i : piece.indices)
      EXPECT_EQ(cloud[std::size_t(i)].x < 1.0f, &piece == &pieces[0]);
  EXPECT_THROW(PlaneCliques(0.0), InvalidParameterException);
}

} // namespace pcl_semantic
