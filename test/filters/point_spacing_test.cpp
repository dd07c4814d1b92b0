// SPDX-License-Identifier: BSD-3-Clause
#include "core/point_spacing.h"
#include "support/brute_force_crf.h"

#include <pcl_semantic/filters/crf_parameters.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pcl_semantic {

namespace {

Eigen::MatrixXf
planeGrid(int width, float step)
{
  Eigen::MatrixXf positions(3, width * width);
  for (int i = 0; i < width * width; ++i)
    positions.col(i) << step * float(i % width), step * float(i / width), 1.0f;
  return positions;
}

// By sorting all distances from every point.
float
plainSpacing(const Eigen::MatrixXf& positions)
{
  std::vector<float> reaches;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    std::vector<float> distances;
    for (Eigen::Index j = 0; j < positions.cols(); ++j)
      if (j != i)
        distances.push_back((positions.col(j) - positions.col(i)).norm());
    std::sort(distances.begin(), distances.end());
    reaches.push_back(distances[3]);
  }
  std::sort(reaches.begin(), reaches.end());
  return reaches[reaches.size() / 2];
}

TEST(PointSpacing, IsTheMedianDistanceToTheFourthNeighbour)
{
  EXPECT_NEAR(pointSpacing(planeGrid(100, 0.1f)), 0.1f, 1e-6f);
  EXPECT_EQ(pointSpacing(planeGrid(30, 250.0f)), 250.0f);
  const Eigen::MatrixXf random = makeRandomMatrix(3, 200, -5.0f, 5.0f, 3);
  EXPECT_FLOAT_EQ(pointSpacing(random), plainSpacing(random)); // all are sampled
}

// Where it is thin or bent too: the fourth neighbours are across corners.
TEST(PointSpacing, OfVoxelsIsTheirSize)
{
  Eigen::MatrixXf line = Eigen::MatrixXf::Zero(3, 60);
  for (int i = 0; i < 60; ++i)
    line(0, i) = 0.1f * float(i) + 700.0f;
  EXPECT_NEAR(pointSpacing(line), 0.1f, 1e-3f);
}

TEST(PointSpacing, DoesNotDependOnTheOrderOfThePoints)
{
  Eigen::MatrixXf points = makeRandomMatrix(3, 3000, -5.0f, 5.0f, 4);
  const float spacing = pointSpacing(points);
  EXPECT_NEAR(spacing, plainSpacing(points), 0.1f * spacing);
  std::vector<int> order(3000);
  for (int i = 0; i < 3000; ++i)
    order[std::size_t(i)] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  const Eigen::MatrixXf before = points;
  for (int i = 0; i < 3000; ++i)
    points.col(i) = before.col(order[std::size_t(i)]);
  EXPECT_EQ(pointSpacing(points), spacing);
}

TEST(PointSpacing, IsZeroWhereThereIsNone)
{
  EXPECT_EQ(pointSpacing(Eigen::MatrixXf(3, 0)), 0.0f);
  EXPECT_EQ(pointSpacing(makeRandomMatrix(3, 4, 0.0f, 1.0f, 6)), 0.0f);
  EXPECT_EQ(pointSpacing(Eigen::MatrixXf::Ones(3, 50)), 0.0f);
}

TEST(AutomaticValues, DependOnTheSensorAndTheDistanceOfThePoints)
{
  const auto deviation = [](PointSensor sensor, double spacing) {
    SemanticCRFParameters parameters;
    parameters.sensor = sensor;
    const SemanticCRFParameters values = parameters.resolved(spacing, true);
    EXPECT_EQ(values.iterations, sensor == PointSensor::stereo ? 1 : 3);
    EXPECT_EQ(values.smoothness_deviation, values.appearance_deviation);
    return values.smoothness_deviation;
  };
  for (const PointSensor sensor : {PointSensor::stereo, PointSensor::lidar}) {
    EXPECT_EQ(deviation(sensor, 0.0), 0.2);
    EXPECT_EQ(deviation(sensor, 0.06), 0.2);
    EXPECT_EQ(deviation(sensor, 0.1), 0.2); // the voxels of a map: not a bit more
    EXPECT_DOUBLE_EQ(deviation(sensor, 0.3), 0.6);
    EXPECT_DOUBLE_EQ(deviation(sensor, 0.005), 0.05);
    EXPECT_DOUBLE_EQ(deviation(sensor, 80.0), 160.0); // millimetres
  }
}

TEST(AutomaticValues, OfColouredPointsAreThoseOfRgbd)
{
  const auto expectDeviations = [](double spacing, double extent, double smoothness,
                                   double appearance) {
    const SemanticCRFParameters values =
        SemanticCRFParameters().resolved(spacing, true, extent);
    EXPECT_EQ(values.sensor, PointSensor::rgbd);
    EXPECT_EQ(values.iterations, 3);
    EXPECT_EQ(values.colour_deviation, 30.0);
    EXPECT_DOUBLE_EQ(values.smoothness_deviation, smoothness);
    EXPECT_DOUBLE_EQ(values.appearance_deviation, appearance);
  };
  expectDeviations(0.0, 0.0, 0.1, 0.2);
  expectDeviations(0.02, 0.0, 0.1, 0.2);
  expectDeviations(0.2, 0.0, 0.2, 0.4);
  expectDeviations(0.004, 1.5, 0.1, 0.2);    // an image of a room
  expectDeviations(0.001, 0.08, 0.01, 0.02); // of a cup
  expectDeviations(4.0, 1500.0, 4.0, 8.0);   // of a room in millimetres
  EXPECT_EQ(SemanticCRFParameters().resolved(0.1, false).sensor, PointSensor::lidar);
}

TEST(AutomaticValues, LeaveValuesThatAreSet)
{
  SemanticCRFParameters parameters;
  parameters.iterations = 7;
  parameters.smoothness_deviation = 0.01;
  parameters.appearance_deviation = 0.02;
  parameters.colour_deviation = 5.0;
  const SemanticCRFParameters values = parameters.resolved(0.3, true, 4.0);
  EXPECT_EQ(values.iterations, 7);
  EXPECT_EQ(values.smoothness_deviation, 0.01);
  EXPECT_EQ(values.appearance_deviation, 0.02);
  EXPECT_EQ(values.colour_deviation, 5.0);
}

} // namespace

} // namespace pcl_semantic
