// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_builder.h"

#include "synthetic_objects.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic::synthetic {

namespace {

// Names of the random sequences: one for each kind of object and side of the street.
enum Kind : std::uint32_t {
  plots = 10,
  parking = 20,
  lamps = 30,
  signs,
  people,
  woods
};

constexpr double kBegin = -24.0; // behind the first camera [m]

/** \brief Length at distance t of what is \a length long on the centre line. */
double
lengthAt(const RoadLine& road, const RoadPoint& point, double length)
{
  return length * (1.0 - point.t * road.curvature(point.s));
}

/** \brief Hedge or fence in pieces short enough to follow the road. */
void
buildBoundary(ObjectBuilder& builder, const RoadLine& road, RoadPoint from, double to,
              Random& random)
{
  const double kind = random.uniform(0.0, 1.0);
  const double height = random.uniform(1.0, 1.7);
  const float tone = static_cast<float>(random.uniform(0.7, 1.2));
  if (kind > 0.86)
    return; // an open front garden
  const int pieces = std::max(1, static_cast<int>((to - from.s) / 2.6));
  const double step = (to - from.s) / pieces;
  for (int k = 0; k < pieces; ++k) {
    const RoadPoint middle{from.s + (k + 0.5) * step, from.t};
    const double length = lengthAt(road, middle, step);
    builder.place(road, middle);
    if (kind < 0.38)
      builder.hedge(length + 0.25, height);
    else
      builder.fence(length + 0.02, height, tone * Eigen::Vector3f(0.36f, 0.25f, 0.15f));
  }
}

/** \brief One plot: a house or a garden behind its fence. */
void
buildPlot(ObjectBuilder& builder, const RoadLine& road, double begin, double length,
          double side, Random& random)
{
  const double front = random.uniform(10.5, 12.5);
  const double depth = 8.5;
  const double middle = begin + 0.5 * length;
  // The narrow side of the plot, in the inside of a turn, limits the house.
  const RoadPoint back{middle, side * (front + depth)};
  const RoadPoint face{middle, side * front};
  const double room =
      std::min(lengthAt(road, back, length), lengthAt(road, face, length)) -
      random.uniform(1.5, 4.0);
  buildBoundary(builder, road, {begin + 0.3, side * 8.1}, begin + length - 0.9, random);
  if (room > 5.0 && random.chance(0.86)) {
    builder.place(road, {middle, side * (front + 0.5 * depth)});
    builder.house(std::min(room, 14.0), depth, random);
  }
  else {
    builder.place(road, {middle + 1.5, side * 12.0});
    builder.tree(random.uniform(6.0, 9.0), random);
  }
  if (random.chance(0.55)) {
    builder.place(road, {begin + 0.3, side * random.uniform(9.3, 9.9)});
    builder.tree(random.uniform(3.8, 6.0), random);
  }
}

void
buildPlots(ObjectBuilder& builder, const RoadLine& road, double end, std::uint32_t seed)
{
  for (const double side : {1.0, -1.0}) {
    Random random(seed, plots + (side > 0.0 ? 1 : 0));
    double s = kBegin;
    while (s < end) {
      const double length = random.uniform(12.0, 17.0);
      buildPlot(builder, road, s, length, side, random);
      s += length;
    }
  }
}

void
buildParkedCars(ObjectBuilder& builder, const RoadLine& road, double end,
                std::uint32_t seed)
{
  for (const double side : {1.0, -1.0}) {
    Random random(seed, parking + (side > 0.0 ? 1 : 0));
    for (double s = kBegin; s < end; s += random.uniform(5.6, 7.5)) {
      if (random.chance(0.62))
        continue;
      builder.place(road, {s, side * random.uniform(4.05, 4.2)},
                    random.uniform(-0.03, 0.03));
      builder.car(random);
    }
  }
}

void
buildFurniture(ObjectBuilder& builder, const RoadLine& road, double end,
               std::uint32_t seed)
{
  Random lamp(seed, lamps);
  double side = 1.0;
  for (double s = 6.0; s < end; s += lamp.uniform(12.0, 15.0), side = -side) {
    builder.place(road, {s, side * 5.65});
    builder.lampPost(-side);
  }
  Random sign(seed, signs);
  side = -1.0;
  for (double s = 11.0; s < end; s += sign.uniform(9.0, 16.0)) {
    builder.place(road, {s, side * 5.8}, sign.uniform(-0.15, 0.15));
    builder.trafficSign(sign);
    side = sign.chance(0.6) ? -1.0 : 1.0;
  }
  Random person(seed, people);
  for (double s = 16.0; s < end; s += person.uniform(18.0, 35.0)) {
    const double t = person.uniform(6.4, 7.1);
    builder.place(road, {s, person.chance(0.5) ? t : -t});
    builder.pedestrian(person);
  }
}

/** \brief Tall trees behind the houses and at the end of the street, so that one never
 * looks into an empty plain. */
void
buildWoods(ObjectBuilder& builder, const RoadLine& road, double end, std::uint32_t seed)
{
  Random random(seed, woods);
  for (double s = kBegin; s < end; s += random.uniform(6.0, 8.0))
    for (const double side : {1.0, -1.0}) {
      const double t = side * random.uniform(26.0, 31.0);
      if (t * road.curvature(s) > 0.6)
        continue; // they would crowd in the inside of the turn
      builder.place(road, {s, t});
      builder.tree(random.uniform(8.0, 11.0), random);
    }
  for (double t = -30.0; t <= 30.0; t += 5.0) {
    builder.place(road, {end + random.uniform(2.0, 6.0), t});
    builder.tree(random.uniform(7.0, 10.0), random);
  }
}

} // namespace

std::vector<Primitive>
buildStreet(const RoadLine& road, double length, std::uint32_t seed)
{
  ObjectBuilder builder(seed);
  buildPlots(builder, road, length, seed);
  buildParkedCars(builder, road, length, seed);
  buildFurniture(builder, road, length, seed);
  buildWoods(builder, road, length, seed);
  return builder.take();
}

} // namespace pcl_semantic::synthetic
