// SPDX-License-Identifier: BSD-3-Clause
#include "room.h"

#include "core/fail.h"
#include "noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

using namespace synthetic;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kHalfLength = 3.0; // inside, along x [m]
constexpr double kHalfWidth = 2.3;  // inside, along y [m]
constexpr double kHeight = 2.6;
constexpr double kWall = 0.1; // thickness of walls, floor and ceiling [m]

const Vector3f kWood(0.36f, 0.22f, 0.12f);
const Vector3f kPaleWood(0.52f, 0.40f, 0.26f);
const Vector3f kSteel(0.34f, 0.36f, 0.37f);
const Vector3f kWhite(0.66f, 0.65f, 0.62f);

// Places the solids of one piece of furniture after the other.
class RoomBuilder {
public:
  explicit RoomBuilder(std::uint32_t seed) : random(seed, 1), seed_(seed) {}

  Random random;

  // Begins a piece at a point of the floor. Its x is to the right of its front, and y
  // to its back. \param[in] quarter_turns to the left
  void
  place(double x, double y, int quarter_turns)
  {
    constexpr std::array<double, 4> cosines{1.0, 0.0, -1.0, 0.0};
    origin_ = {x, y, 0.0};
    cosine_ = cosines[std::size_t(quarter_turns & 3)];
    sine_ = cosines[std::size_t((quarter_turns + 3) & 3)];
  }

  // \param[in] bottom centre of the lower side, in the piece's axes [m]
  Primitive&
  add(Label label, Shape shape, const Vector3d& bottom, const Vector3d& size,
      const Vector3f& colour, Material material = Material::cloth)
  {
    Primitive solid;
    solid.shape = shape;
    solid.material = material;
    solid.label = label;
    solid.id = std::max(hash(seed_, std::uint32_t(solids_.size()), 0x501d), 2u);
    solid.half = 0.5 * size;
    solid.cosine = cosine_;
    solid.sine = sine_;
    solid.colour = colour;
    solid.centre = origin_ + solid.toWorld(bottom + Vector3d(0, 0, 0.5 * size.z()));
    solids_.push_back(solid);
    return solids_.back();
  }

  Primitive&
  box(Label label, const Vector3d& bottom, const Vector3d& size, const Vector3f& colour,
      Material material = Material::cloth)
  {
    return add(label, Shape::box, bottom, size, colour, material);
  }

  std::vector<Primitive>
  take()
  {
    return std::move(solids_);
  }

  Vector3f
  colour(double brightness)
  {
    Vector3f c;
    for (int k = 0; k < 3; ++k)
      c[k] = static_cast<float>(brightness * random.uniform(0.3, 1.3));
    return c;
  }

  void
  shell()
  {
    place(0.0, 0.0, 0);
    const double length = 2.0 * kHalfLength, width = 2.0 * kHalfWidth;
    box(room_floor, {0, 0, -kWall}, {length, width, kWall}, kPaleWood,
        Material::boards);
    box(room_ceiling, {0, 0, kHeight}, {length, width, kWall}, kWhite);
    const Vector3f paint = kWhite + 0.1f * colour(1.0);
    for (const double side : {-1.0, 1.0}) {
      box(room_wall, {side * (kHalfLength + 0.5 * kWall), 0, -kWall},
          {kWall, width + 2.0 * kWall, kHeight + 2.0 * kWall}, paint);
      box(room_wall, {0, side * (kHalfWidth + 0.5 * kWall), -kWall},
          {length, kWall, kHeight + 2.0 * kWall}, paint);
    }
    box(room_floor, {0, 0, 0}, {2.2, 1.5, 0.012}, colour(0.3)); // carpet
  }

  // A flat thing on the wall behind the piece.
  void
  hang(Label label, double height, double width, double tall, const Vector3f& colour)
  {
    box(label, {0, -0.008, height}, {width, 0.016, tall}, kWood);
    box(label, {0, -0.010, height + 0.04}, {width - 0.08, 0.02, tall - 0.08}, colour);
  }

  // Objects of a table or a shelf, in a row along x.
  void
  books(const Vector3d& left, double length, double height)
  {
    for (double x = 0.0; x < length;) {
      const double width = random.uniform(0.02, 0.05);
      const double tall = height * random.uniform(0.7, 0.95);
      const double deep = random.uniform(0.16, 0.22);
      if (x + width > length)
        break;
      if (random.chance(0.93))
        box(room_books, left + Vector3d(x + 0.5 * width, -0.5 * deep, 0.0),
            {width, deep, tall}, colour(0.4));
      x += width + 0.001;
    }
  }

  void
  cup(const Vector3d& bottom)
  {
    const Vector3f paint = colour(0.5);
    add(room_objects, Shape::cylinder, bottom, {0.08, 0.08, 0.1}, paint);
    add(room_objects, Shape::ellipsoid, bottom + Vector3d(0, 0, 0.09),
        {0.08, 0.08, 0.02}, paint * 0.5f);
  }

  void
  legs(Label label, const Eigen::Vector2d& middle, double x, double y, double height,
       double width, const Vector3f& colour)
  {
    for (const double left : {-x, x})
      for (const double back : {-y, y})
        box(label, {middle.x() + left, middle.y() + back, 0}, {width, width, height},
            colour);
  }

  void
  table()
  {
    const double length = random.uniform(1.3, 1.6);
    box(room_table, {0, 0, 0.71}, {length, 0.85, 0.03}, kWood, Material::boards);
    legs(room_table, {0, 0}, 0.5 * length - 0.06, 0.36, 0.71, 0.06, kWood);
    box(room_tv, {0.1, 0.25, 0.76}, {0.5, 0.03, 0.32}, Vector3f::Constant(0.05f));
    box(room_tv, {0.1, 0.25, 0.74}, {0.2, 0.16, 0.02}, Vector3f::Constant(0.08f));
    box(room_objects, {0.1, -0.1, 0.74}, {0.42, 0.15, 0.02}, Vector3f::Constant(0.1f));
    for (int k = 0; k < 3; ++k) {
      const double wide = random.uniform(0.18, 0.24);
      box(room_books, {-0.45, 0.1, 0.74 + 0.035 * k}, {wide, 0.28, 0.035}, colour(0.4));
    }
    cup({0.5, -0.2, 0.74});
  }

  void
  chair()
  {
    const Vector3f paint = colour(0.25);
    box(room_chair, {0, 0, 0.43}, {0.44, 0.44, 0.04}, paint);
    legs(room_chair, {0, 0}, 0.19, 0.19, 0.43, 0.04, kWood);
    box(room_chair, {0, 0.2, 0.47}, {0.44, 0.04, 0.45}, paint);
  }

  void
  shelves()
  {
    constexpr double width = 1.6, depth = 0.32, height = 2.0;
    for (const double side : {-1.0, 1.0})
      box(room_furniture, {side * 0.5 * width, -0.5 * depth, 0}, {0.03, depth, height},
          kPaleWood);
    box(room_furniture, {0, -0.01, 0}, {width, 0.02, height}, kPaleWood);
    for (int board = 0; board < 6; ++board) {
      const double z = 0.06 + 0.38 * board;
      box(room_furniture, {0, -0.5 * depth, z}, {width, depth, 0.025}, kPaleWood);
      if (board == 5)
        break;
      const double length = random.uniform(0.4, 1.45);
      books({-0.5 * width + 0.04, -0.03, z + 0.025}, length, 0.3);
      if (length < 1.0) // a box beside the books
        box(room_objects, {0.5 * length, -0.16, z + 0.025},
            {0.3, 0.22, random.uniform(0.12, 0.28)}, colour(0.4));
    }
  }

  void
  wardrobe()
  {
    box(room_furniture, {0, -0.3, 0}, {1.3, 0.6, 2.1}, kWood * 1.3f);
    for (const double side : {-1.0, 1.0})
      box(room_furniture, {side * 0.06, -0.61, 1.0}, {0.02, 0.02, 0.2}, kSteel);
  }

  void
  bed()
  {
    const Vector3f sheet = colour(0.45);
    box(room_bed, {0, -1.0, 0.1}, {1.4, 2.0, 0.25}, kWood);
    legs(room_bed, {0, -1.0}, 0.66, 0.96, 0.1, 0.06, kWood);
    box(room_bed, {0, -1.0, 0.35}, {1.36, 1.96, 0.17}, sheet);
    for (const double side : {-1.0, 1.0})
      add(room_bed, Shape::ellipsoid, {side * 0.33, -0.3, 0.46}, {0.58, 0.4, 0.2},
          kWhite);
  }

  void
  sofa()
  {
    const Vector3f cover = colour(0.3);
    box(room_sofa, {0, -0.45, 0.1}, {1.8, 0.9, 0.32}, cover);
    legs(room_sofa, {0, -0.45}, 0.84, 0.4, 0.1, 0.06, kWood);
    box(room_sofa, {0, -0.12, 0.42}, {1.8, 0.22, 0.42}, cover);
    for (const double side : {-1.0, 1.0}) {
      box(room_sofa, {side * 0.81, -0.45, 0.42}, {0.18, 0.88, 0.2}, cover * 0.9f);
      add(room_sofa, Shape::ellipsoid, {side * 0.4, -0.3, 0.42}, {0.45, 0.2, 0.4},
          colour(0.4));
    }
  }

  void
  plant()
  {
    add(room_objects, Shape::cylinder, {0, 0, 0}, {0.3, 0.3, 0.3},
        Vector3f(0.35f, 0.16f, 0.1f));
    add(room_objects, Shape::ellipsoid, {0, 0, 0.26}, {0.3, 0.3, 0.06},
        Vector3f(0.06f, 0.04f, 0.03f)); // soil
    Primitive& leaves = add(room_objects, Shape::bush, {0, 0, 0.28}, {0.55, 0.55, 0.8},
                            Vector3f(0.08f, 0.2f, 0.05f), Material::leaves);
    leaves.roughness = 0.4;
  }

  void
  bin()
  {
    add(room_objects, Shape::cylinder, {0, 0, 0}, {0.28, 0.28, 0.35}, colour(0.3));
    add(room_objects, Shape::ellipsoid, {0, 0, 0.33}, {0.28, 0.28, 0.04},
        Vector3f::Constant(0.05f));
  }

private:
  std::uint32_t seed_;
  Vector3d origin_ = Vector3d::Zero();
  double cosine_ = 1.0, sine_ = 0.0;
  std::vector<Primitive> solids_;
};

std::vector<Primitive>
furnish(std::uint32_t seed)
{
  RoomBuilder room(seed);
  Random& random = room.random;
  room.shell();
  const auto shift = [&] { return random.uniform(-0.15, 0.15); };
  // Each piece stands with its back to a wall: +y with 0 quarter turns, -x with 1.
  const double table_x = shift(), table_y = shift();
  room.place(table_x, table_y, 0);
  room.table();
  room.place(table_x - 0.35, table_y - 0.75 + shift(), 2);
  room.chair();
  room.place(table_x + 0.4, table_y + 0.8 + 0.3 * shift(), 0);
  room.chair();
  room.place(-1.7 + shift(), kHalfWidth, 0);
  room.shelves();
  room.place(0.4 + shift(), kHalfWidth, 0);
  room.hang(room_window, 0.95, 1.5, 1.25, Vector3f(0.75f, 0.85f, 1.0f));
  room.place(2.2 + shift(), kHalfWidth, 0);
  room.wardrobe();
  room.place(-kHalfLength, -0.6 + shift(), 1);
  room.bed();
  room.hang(room_picture, 1.3, 0.9, 0.6, room.colour(0.5));
  room.place(0.5 + shift(), -kHalfWidth, 2);
  room.sofa();
  room.hang(room_picture, 1.35, 1.1, 0.7, room.colour(0.5));
  room.place(kHalfLength, -0.2 + shift(), 3);
  room.hang(room_tv, 1.0, 1.3, 0.75, Vector3f::Constant(0.04f));
  room.box(room_furniture, {0, -0.2, 0}, {1.5, 0.4, 0.5}, kWhite * 0.8f);
  room.cup({0.5, -0.2, 0.5});
  room.books({-0.7, -0.1, 0.5}, 0.4, 0.25);
  room.place(kHalfLength - 0.4, -kHalfWidth + 0.4, 0);
  room.plant();
  room.place(-1.9 + shift(), -kHalfWidth + 0.25, 0);
  room.bin();
  room.place(1.2, kHalfWidth - 0.3, 0);
  room.box(room_objects, {0, 0, 0}, {0.4, 0.3, 0.28}, Vector3f(0.42f, 0.3f, 0.18f));
  return room.take();
}

} // namespace

SyntheticRoom::SyntheticRoom(std::uint32_t seed, int frames)
    : seed_(seed), frames_(frames), lamp_(0.3, -0.2, kHeight - 0.25),
      solids_(std::make_shared<BoxTree>(furnish(seed)))
{
  if (frames < 1 || frames > 100000)
    fail<InvalidParameterException>("frames of a synthetic room: ", frames,
                                    ", expected 1 to 100000");
}

Eigen::Isometry3d
SyntheticRoom::pose(int frame) const
{
  if (frame < 0 || frame >= frames_)
    fail<InvalidParameterException>("frame ", frame, " of a synthetic room with ",
                                    frames_, " frames");
  constexpr double two_pi = 6.283185307179586;
  const double turn = two_pi * frame / frames_ - 0.5 * two_pi; // in sinCos()'s range
  const auto [sine, cosine] = sinCos(turn);
  const auto [nod_sine, nod_cosine] = sinCos(0.18 + 0.4 * sine * cosine);
  Eigen::Matrix3d axes; // right, down, forward as columns
  axes.col(2) << -cosine * nod_cosine, -sine * nod_cosine, -nod_sine;
  axes.col(0) << -sine, cosine, 0.0;
  axes.col(1) = axes.col(2).cross(axes.col(0));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = axes;
  pose.translation() << 1.5 * cosine, 1.0 * sine, 1.6 + 0.1 * sine;
  return pose;
}

bool
SyntheticRoom::nearest(const Ray& ray, Surface& surface) const
{
  surface.distance = 100.0 / ray.direction.norm();
  return nearestSolid(*solids_, ray, surface);
}

double
SyntheticRoom::lampLight(const Surface& surface) const
{
  const Vector3d to_lamp = lamp_ - surface.point;
  const double distance = to_lamp.norm();
  const double facing = surface.normal.dot(to_lamp) / distance;
  if (facing <= 0.0)
    return 0.0;
  const Vector3d start = surface.point + 0.005 * surface.normal;
  if (solids_->blocked({start, to_lamp / distance}, distance))
    return 0.0;
  return facing / (1.0 + 0.15 * distance * distance);
}

} // namespace pcl_semantic
