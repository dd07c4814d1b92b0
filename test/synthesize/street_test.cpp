// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/objects.h"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>

using namespace pcl_semantic;
using namespace pcl_semantic::synthetic;

namespace {

Eigen::Vector3d
randomDirection(Random& random)
{
  Eigen::Vector3d direction;
  do
    for (int axis = 0; axis < 3; ++axis)
      direction[axis] = random.uniform(-1.0, 1.0);
  while (direction.norm() > 1.0 || direction.norm() < 0.1);
  return direction;
}

} // namespace

TEST(SyntheticNoise, IsSmoothBoundedAndUncorrelated)
{
  Random random(1, 2);
  double sum = 0.0, square = 0.0;
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = 100.0 * randomDirection(random);
    const double value = valueNoise(p, 7);
    ASSERT_LE(std::abs(value), 1.0);
    ASSERT_NEAR(valueNoise(p + Eigen::Vector3d(1e-4, -1e-4, 1e-4), 7), value, 2e-3);
    sum += value;
    square += value * value;
  }
  EXPECT_NEAR(sum / count, 0.0, 0.02);
  EXPECT_GT(square / count, 0.03);
}

TEST(SyntheticNoise, SineAndCosineAreTheLibrarys)
{
  for (double angle = -4.0; angle <= 4.0; angle += 0.01) {
    const auto [sine, cosine] = sinCos(angle);
    EXPECT_NEAR(sine, std::sin(angle), 1e-13);
    EXPECT_NEAR(cosine, std::cos(angle), 1e-13);
  }
}

TEST(SyntheticRoad, FindsThePlaceOfEveryPosition)
{
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const RoadLine road({3.0, 1.6}, 400.0, seed);
    Random random(seed, 3);
    for (int i = 0; i < 2000; ++i) {
      const RoadPoint place{random.uniform(-20.0, 400.0), random.uniform(-12.0, 12.0)};
      const RoadPoint found = road.locate(road.position(place));
      ASSERT_NEAR(found.t, place.t, 1e-9) << "seed " << seed << " s " << place.s;
      ASSERT_NEAR(found.s, place.s, 1e-9) << "seed " << seed << " t " << place.t;
    }
  }
}

TEST(SyntheticRoad, TurnsWithoutJumps)
{
  const RoadLine road({0.0, 0.0}, 300.0, 5);
  double largest_turn = 0.0;
  for (double s = 0.0; s < 300.0; s += 0.5) {
    const Eigen::Vector2d step =
        road.position({s + 0.5, 0.0}) - road.position({s, 0.0});
    ASSERT_NEAR(step.norm(), 0.5, 1e-3);
    ASSERT_NEAR(std::atan2(step.y(), step.x()), road.heading(s + 0.25), 1e-2);
    largest_turn = std::max(largest_turn, std::abs(road.heading(s)));
  }
  EXPECT_GT(largest_turn, 0.7);
}

TEST(SyntheticShapes, EllipsoidAndBoxAreMetWhereTheirEquationsSay)
{
  Primitive body;
  body.centre = {4.0, -2.0, 1.0};
  body.half = {1.5, 0.7, 0.9};
  std::tie(body.sine, body.cosine) = sinCos(0.6);
  Random random(9, 9);
  int hits = 0;
  for (int i = 0; i < 4000; ++i) {
    body.shape = i % 2 ? Shape::ellipsoid : Shape::box;
    const Ray ray{body.centre + 6.0 * randomDirection(random).normalized(),
                  randomDirection(random)};
    double distance = 100.0;
    Eigen::Vector3d normal;
    if (!intersect(body, ray, distance, &normal))
      continue;
    ++hits;
    const Eigen::Vector3d q =
        body.toLocal(ray.origin + distance * ray.direction - body.centre)
            .cwiseQuotient(body.half);
    ASSERT_NEAR(i % 2 ? q.norm() : q.cwiseAbs().maxCoeff(), 1.0, 1e-9);
    ASSERT_NEAR(normal.norm(), 1.0, 1e-9);
    ASSERT_LT(body.toWorld(normal).dot(ray.direction), 0.0);
  }
  EXPECT_GT(hits, 50);
}

TEST(SyntheticBoxTree, FindsWhatTryingEveryPrimitiveFinds)
{
  const RoadLine road({0.0, 1.6}, 120.0, 4);
  const std::vector<Primitive> primitives = buildStreet(road, 120.0, 4);
  const BoxTree tree(primitives);
  Random random(4, 4);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const RoadPoint place{random.uniform(0.0, 100.0), random.uniform(-7.0, 7.0)};
    Ray ray;
    ray.origin.head<2>() = road.position(place);
    ray.origin.z() = random.uniform(-1.5, 2.0);
    ray.direction = randomDirection(random);
    if (i % 10 == 0)
      ray.direction = {1.0, 0.0, 0.0};
    double expected = 80.0;
    std::uint32_t expected_id = 0;
    Eigen::Vector3d normal;
    for (const Primitive& primitive : primitives)
      if (intersect(primitive, ray, expected, &normal))
        expected_id = primitive.id;
    double distance = 80.0;
    const Primitive* found = tree.nearest(ray, distance, normal);
    ASSERT_EQ(distance, expected);
    ASSERT_EQ(found ? found->id : 0, expected_id);
    ASSERT_EQ(tree.blocked(ray, 80.0), expected_id != 0);
    hits += expected_id != 0;
  }
  EXPECT_GT(hits, 700);
}
