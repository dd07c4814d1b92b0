// SPDX-License-Identifier: BSD-3-Clause
#include "objects.h"

#include "street.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace pcl_semantic::synthetic {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3f kSteel(0.34f, 0.36f, 0.37f);

template <std::size_t N>
const Vector3f&
choose(const std::array<Vector3f, N>& colours, Random& random)
{
  return colours[random.bits() % N];
}

const std::array<Vector3f, 7> kPlaster{
    Vector3f(0.62f, 0.56f, 0.46f), Vector3f(0.68f, 0.66f, 0.60f),
    Vector3f(0.60f, 0.46f, 0.34f), Vector3f(0.45f, 0.22f, 0.16f),
    Vector3f(0.52f, 0.54f, 0.55f), Vector3f(0.66f, 0.55f, 0.30f),
    Vector3f(0.50f, 0.30f, 0.22f)};
const std::array<Vector3f, 4> kTiles{
    Vector3f(0.34f, 0.14f, 0.09f), Vector3f(0.22f, 0.12f, 0.10f),
    Vector3f(0.14f, 0.14f, 0.16f), Vector3f(0.28f, 0.18f, 0.12f)};
const std::array<Vector3f, 7> kPaint{
    Vector3f(0.50f, 0.51f, 0.53f), Vector3f(0.10f, 0.10f, 0.12f),
    Vector3f(0.70f, 0.70f, 0.70f), Vector3f(0.40f, 0.05f, 0.05f),
    Vector3f(0.07f, 0.13f, 0.32f), Vector3f(0.22f, 0.24f, 0.26f),
    Vector3f(0.10f, 0.22f, 0.16f)};
const std::array<Vector3f, 4> kCloth{
    Vector3f(0.30f, 0.08f, 0.07f), Vector3f(0.08f, 0.12f, 0.28f),
    Vector3f(0.35f, 0.32f, 0.20f), Vector3f(0.12f, 0.25f, 0.15f)};

// Properties of a solid except its size and colour.
struct Solid {
  Shape shape;
  Material material;
  Label label;
};

constexpr Solid kWall{Shape::box, Material::wall, synthetic_building};
constexpr Solid kRoof{Shape::box, Material::roof, synthetic_building};
constexpr Solid kTrunk{Shape::cylinder, Material::bark, synthetic_vegetation};
constexpr Solid kLeaves{Shape::bush, Material::leaves, synthetic_vegetation};
constexpr Solid kBoards{Shape::box, Material::boards, synthetic_fence};
constexpr Solid kCarBody{Shape::box, Material::car_body, synthetic_car};
constexpr Solid kCarCabin{Shape::box, Material::car_cabin, synthetic_car};
constexpr Solid kTyre{Shape::ellipsoid, Material::tyre, synthetic_car};
constexpr Solid kPost{Shape::cylinder, Material::metal, synthetic_pole};
constexpr Solid kBar{Shape::box, Material::metal, synthetic_pole};
constexpr Solid kRoundSign{Shape::ellipsoid, Material::sign, synthetic_sign};
constexpr Solid kSquareSign{Shape::box, Material::sign, synthetic_sign};
constexpr Solid kLimb{Shape::ellipsoid, Material::cloth, synthetic_pedestrian};

// Names of the random sequences, one per kind of object and side of the street.
enum Kind : std::uint32_t {
  plots = 10,
  parking = 20,
  lamps = 30,
  signs,
  people,
  woods,
  traffic
};

// Adds the solids of one object after the other. An object has a position along the
// road, a ground height and a heading.
class ObjectBuilder {
public:
  ObjectBuilder(const RoadLine& line, std::uint32_t number, int first_object)
      : road(line), seed(number), next_number_(first_object)
  {}

  const RoadLine& road;
  const std::uint32_t seed;

  // Starts the next object, with a heading relative to the road's [rad].
  void
  place(const RoadPoint& point, double turned = 0.0)
  {
    ground_.head<2>() = road.position(point);
    ground_.z() =
        Street::road_height +
        (std::abs(point.t) < RoadLine::half_width ? 0.0 : RoadLine::kerb_height);
    std::tie(sine_, cosine_) = sinCos(road.heading(point.s) + turned);
    object_ = hash(seed, static_cast<std::uint32_t>(std::lround(point.s * 1000.0)),
                   static_cast<std::uint32_t>(std::lround(point.t * 1000.0)));
    parts_ = 0;
    number_ = 0;
  }

  // Starts the driving car of a number. Its texture does not depend on its position.
  void
  placeDriving(const RoadPoint& point, int number)
  {
    place(point);
    if (point.t < 0.0) { // turns the rear, which is at +x, to the camera
      sine_ = -sine_;
      cosine_ = -cosine_;
    }
    object_ = hash(seed, traffic, static_cast<std::uint32_t>(number));
    next_number_ = number;
  }

  // \a width along the street, \a depth across [m].
  void
  house(double width, double depth, Random& random)
  {
    const double height = 2.9 * (random.chance(0.35) ? 3 : 2) + 0.4;
    const double roof_height = random.uniform(2.2, 3.4);
    const Vector3f wall = choose(kPlaster, random);
    const Vector3f roof = choose(kTiles, random);
    const bool gable_to_street = random.chance(0.4);
    add(kWall, {0, 0, 0}, {width, depth, height}, wall);
    add(kWall, {0, 0, 0}, {width + 0.1, depth + 0.1, 0.5}, wall * 0.5f);
    Primitive& cover =
        add(kRoof, {0, 0, height}, {width + 0.6, depth + 0.6, roof_height}, roof);
    if (gable_to_street)
      cover.taper.x() = cover.half.x() - 0.1;
    else
      cover.taper.y() = cover.half.y() - 0.1;
    add(kWall, {random.uniform(-0.3, 0.3) * width, 0, height + 0.5 * roof_height},
        {0.7, 0.9, 0.5 * roof_height + 0.6}, Vector3f(0.36f, 0.20f, 0.16f));
  }

  void
  tree(double height, Random& random)
  {
    const double trunk = 0.32 * height;
    const double reach = random.uniform(0.42, 0.55) * height;
    const double hue = random.uniform(0.0, 1.0);
    const Vector3f leaves(0.09f + 0.09f * float(hue), 0.20f + 0.03f * float(hue),
                          0.045f);
    add(kTrunk, {0, 0, 0}, {0.05 * height, 0.05 * height, trunk + 0.2 * height},
        Vector3f(0.20f, 0.15f, 0.10f));
    for (int k = 0; k < 3; ++k) {
      const double size = reach * random.uniform(0.75, 1.15);
      // In sequence, because the evaluation order of arguments depends on the compiler.
      const double up = trunk * random.uniform(0.75, 1.0) + 0.2 * height * k;
      const double left = 0.35 * reach * random.uniform(-1.0, 1.0);
      const double along = 0.35 * reach * random.uniform(-1.0, 1.0);
      const Vector3d extent(1.1 * size, 1.1 * size, 0.9 * size);
      add(kLeaves, {along, left, up}, extent, leaves).roughness = 0.42;
    }
  }

  void
  hedge(double length, double height)
  {
    Primitive& bush = add(kLeaves, {0, 0, -0.15}, {length, 0.8, height + 0.15},
                          Vector3f(0.08f, 0.17f, 0.05f));
    bush.roughness = 0.16;
    bush.square = true;
  }

  void
  fence(double length, double height, const Vector3f& colour)
  {
    add(kBoards, {0, 0, 0.0}, {length, 0.05, height}, colour);
    add(kBoards, {-0.5 * length, 0, 0.0}, {0.12, 0.14, height + 0.12}, colour * 0.8f);
  }

  // \param[in] is_driving whether its front is at -x; else it is random
  void
  car(Random& random, bool is_driving = false)
  {
    number_ = next_number_++;
    const Vector3f paint = choose(kPaint, random);
    const double length = random.uniform(3.8, 4.6);
    const double width = random.uniform(1.68, 1.8);
    const bool estate = random.chance(0.4);
    const double front = random.chance(0.5) && !is_driving ? 1.0 : -1.0;
    add(kCarBody, {0, 0, 0.22}, {length, width, 0.42}, paint).taper.setConstant(-0.03);
    add(kCarBody, {0, 0, 0.64}, {length - 0.04, width + 0.02, 0.24}, paint).taper = {
        0.22, 0.12};
    Primitive& cabin = add(kCarCabin, {front * (estate ? -0.45 : -0.2), 0, 0.86},
                           {(estate ? 0.68 : 0.6) * length, width - 0.14, 0.58}, paint);
    cabin.taper = {estate ? 0.38 : 0.55, 0.16};
    for (const double x : {-0.31, 0.31})
      for (const double y : {-1.0, 1.0})
        add(kTyre, {x * length, y * (0.5 * width - 0.08), 0.0}, {0.62, 0.24, 0.62},
            Vector3f(0.02f, 0.02f, 0.02f));
  }

  // \param[in] towards_road +1 if the road is to the object's left, else -1
  void
  lampPost(double towards_road)
  {
    add(kPost, {0, 0, 0}, {0.16, 0.16, 6.2}, kSteel);
    add(kPost, {0, 0, 0}, {0.28, 0.28, 1.0}, kSteel);
    add(kBar, {0, towards_road * 0.7, 6.1}, {0.09, 1.5, 0.09}, kSteel);
    add(kBar, {0, towards_road * 1.5, 6.02}, {0.28, 0.7, 0.14},
        Vector3f(0.5f, 0.5f, 0.5f));
  }

  void
  trafficSign(Random& random)
  {
    const bool round = random.chance(0.5);
    const Vector3f colour = random.chance(0.5) ? Vector3f(0.05f, 0.14f, 0.50f)
                                               : Vector3f(0.55f, 0.04f, 0.04f);
    add(kPost, {0, 0, 0}, {0.09, 0.09, 2.75}, kSteel);
    add(round ? kRoundSign : kSquareSign, {-0.07, 0, 2.0}, {0.05, 0.72, 0.72}, colour);
  }

  void
  pedestrian(Random& random)
  {
    number_ = next_number_++;
    const Vector3f coat = choose(kCloth, random);
    const double stride = random.uniform(0.1, 0.22);
    for (const double side : {-1.0, 1.0}) {
      add(kLimb, {side * stride, side * 0.1, 0.0}, {0.2, 0.2, 0.95},
          Vector3f(0.06f, 0.07f, 0.12f));
      add(kLimb, {-side * stride, side * 0.27, 0.75}, {0.14, 0.14, 0.7}, coat * 0.9f);
    }
    add(kLimb, {0, 0, 0.75}, {0.34, 0.5, 0.8}, coat);
    add(kLimb, {0, 0, 1.5}, {0.22, 0.19, 0.27}, Vector3f(0.50f, 0.33f, 0.24f));
  }

  std::vector<Primitive>
  take()
  {
    return std::move(primitives_);
  }

private:
  // Adds a solid of the object. \a bottom is the centre of its lower side, in the
  // object's axes (x along, y left, z up from the ground) [m].
  Primitive&
  add(const Solid& kind, const Vector3d& bottom, const Vector3d& size,
      const Vector3f& colour)
  {
    Primitive solid;
    solid.shape = kind.shape;
    solid.material = kind.material;
    solid.label = kind.label;
    solid.id = std::max(hash(object_, ++parts_), 1u);
    solid.object = number_;
    solid.cosine = cosine_;
    solid.sine = sine_;
    solid.half = 0.5 * size;
    solid.centre = ground_ + solid.toWorld(bottom) + Vector3d(0.0, 0.0, solid.half.z());
    solid.colour = colour;
    primitives_.push_back(solid);
    return primitives_.back();
  }

  std::vector<Primitive> primitives_;
  Vector3d ground_ = Vector3d::Zero();
  double cosine_ = 1.0;
  double sine_ = 0.0;
  std::uint32_t object_ = 0; // identifies the object
  std::uint32_t parts_ = 0;
  int next_number_; // of the next car or pedestrian
  int number_ = 0;  // of the object, 0 = none
};

constexpr double kBegin = -24.0; // behind the first camera [m]

// Length at distance t of \a length on the centre line.
double
lengthAt(const RoadLine& road, const RoadPoint& point, double length)
{
  return length * (1.0 - point.t * road.curvature(point.s));
}

// Hedge or fence in sections short enough to follow the road.
void
buildBoundary(ObjectBuilder& builder, RoadPoint from, double to, Random& random)
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
    const double length = lengthAt(builder.road, middle, step);
    builder.place(middle);
    if (kind < 0.38)
      builder.hedge(length + 0.25, height);
    else
      builder.fence(length + 0.02, height, tone * Eigen::Vector3f(0.36f, 0.25f, 0.15f));
  }
}

// One plot: a building or a garden behind its fence.
void
buildPlot(ObjectBuilder& builder, double begin, double length, double side,
          Random& random)
{
  const double front = random.uniform(10.5, 12.5);
  const double depth = 8.5;
  const double middle = begin + 0.5 * length;
  // The narrow side of the plot, on the inside of a turn, limits the building.
  const RoadPoint back{middle, side * (front + depth)};
  const RoadPoint face{middle, side * front};
  const double room = std::min(lengthAt(builder.road, back, length),
                               lengthAt(builder.road, face, length)) -
                      random.uniform(1.5, 4.0);
  buildBoundary(builder, {begin + 0.3, side * 8.1}, begin + length - 0.9, random);
  if (room > 5.0 && random.chance(0.86)) {
    builder.place({middle, side * (front + 0.5 * depth)});
    builder.house(std::min(room, 14.0), depth, random);
  }
  else {
    builder.place({middle + 1.5, side * 12.0});
    builder.tree(random.uniform(6.0, 9.0), random);
  }
  if (random.chance(0.55)) {
    builder.place({begin + 0.3, side * random.uniform(9.3, 9.9)});
    builder.tree(random.uniform(3.8, 6.0), random);
  }
}

void
buildPlots(ObjectBuilder& builder, double end)
{
  for (const double side : {1.0, -1.0}) {
    Random random(builder.seed, plots + (side > 0.0 ? 1 : 0));
    double s = kBegin;
    while (s < end) {
      const double length = random.uniform(12.0, 17.0);
      buildPlot(builder, s, length, side, random);
      s += length;
    }
  }
}

void
buildParkedCars(ObjectBuilder& builder, double end)
{
  for (const double side : {1.0, -1.0}) {
    Random random(builder.seed, parking + (side > 0.0 ? 1 : 0));
    for (double s = kBegin; s < end; s += random.uniform(5.6, 7.5)) {
      if (random.chance(0.62))
        continue;
      const double turned = random.uniform(-0.03, 0.03);
      builder.place({s, side * random.uniform(4.05, 4.2)}, turned);
      builder.car(random);
    }
  }
}

void
buildFurniture(ObjectBuilder& builder, double end)
{
  Random lamp(builder.seed, lamps);
  double side = 1.0;
  for (double s = 6.0; s < end; s += lamp.uniform(12.0, 15.0), side = -side) {
    builder.place({s, side * 5.65});
    builder.lampPost(-side);
  }
  Random sign(builder.seed, signs);
  side = -1.0;
  for (double s = 11.0; s < end; s += sign.uniform(9.0, 16.0)) {
    builder.place({s, side * 5.8}, sign.uniform(-0.15, 0.15));
    builder.trafficSign(sign);
    side = sign.chance(0.6) ? -1.0 : 1.0;
  }
  Random person(builder.seed, people);
  for (double s = 16.0; s < end; s += person.uniform(18.0, 35.0)) {
    const double t = person.uniform(6.4, 7.1);
    builder.place({s, person.chance(0.5) ? t : -t});
    builder.pedestrian(person);
  }
}

// Tall trees behind the buildings and at the end of the street, which hide the empty
// plain.
void
buildWoods(ObjectBuilder& builder, double end)
{
  Random random(builder.seed, woods);
  for (double s = kBegin; s < end; s += random.uniform(6.0, 8.0))
    for (const double side : {1.0, -1.0}) {
      const double t = side * random.uniform(26.0, 31.0);
      if (t * builder.road.curvature(s) > 0.6)
        continue; // they would crowd on the inside of the turn
      builder.place({s, t});
      builder.tree(random.uniform(8.0, 11.0), random);
    }
  for (double t = -30.0; t <= 30.0; t += 5.0) {
    builder.place({end + random.uniform(2.0, 6.0), t});
    builder.tree(random.uniform(7.0, 10.0), random);
  }
}

} // namespace

std::vector<Primitive>
buildStreet(const RoadLine& road, double length, std::uint32_t seed, int first_object)
{
  ObjectBuilder builder(road, seed, first_object);
  buildPlots(builder, length);
  buildParkedCars(builder, length);
  buildFurniture(builder, length);
  buildWoods(builder, length);
  return builder.take();
}

std::vector<Primitive>
buildTraffic(const RoadLine& road, double length, std::uint32_t seed,
             const std::vector<DrivingCar>& cars, int frame)
{
  ObjectBuilder builder(road, seed, 1);
  int number = 0;
  for (const auto& [start, speed] : cars) {
    ++number;
    const RoadPoint point{start.s + speed * frame, start.t};
    if (point.s < kBegin || point.s > length)
      continue;
    builder.placeDriving(point, number);
    Random random(seed, hash(traffic, static_cast<std::uint32_t>(number)));
    builder.car(random, true);
  }
  return builder.take();
}

} // namespace pcl_semantic::synthetic
