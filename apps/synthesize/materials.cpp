// SPDX-License-Identifier: BSD-3-Clause
#include "materials.h"

#include "street.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic::synthetic {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3f
skyColour(const Vector3d& direction, std::uint32_t seed)
{
  const double up = std::max(direction.z(), 0.0);
  const float height = static_cast<float>(std::min(1.0, 2.2 * up));
  const Vector3f clear = Vector3f(0.62f, 0.74f, 0.86f) * (1.0f - height) +
                         Vector3f(0.20f, 0.38f, 0.74f) * height;
  const Vector3d plane(direction.x() / (up + 0.12), direction.y() / (up + 0.12), 0.0);
  const double cloud =
      fractalNoise(plane, 1.6, seed) + 0.3 * valueNoise(plane * 5.0, seed + 9);
  const float cover = static_cast<float>(std::clamp(1.3 * cloud + 0.15, 0.0, 1.0));
  return clear * (1.0f - cover) + Vector3f(0.88f, 0.89f, 0.90f) * cover;
}

namespace {

double
fraction(double x)
{
  return x - std::floor(x);
}

/** \brief Whether a structure of this size [m] is still resolved. */
bool
resolved(double size, double footprint)
{
  return size > 1.2 * footprint;
}

/** \brief Position of a point within the cells of a grid, each with its own number. */
struct Cell {
  double u = 0.0; ///< 0..size_u
  double v = 0.0;
  std::uint32_t number = 0;
};

Cell
cellOf(double u, double v, double size_u, double size_v, std::uint32_t seed)
{
  const int i = static_cast<int>(std::floor(u / size_u));
  const int j = static_cast<int>(std::floor(v / size_v));
  return {u - i * size_u, v - j * size_v, hash(i, j, seed)};
}

Vector3f
asphalt(const Surface& surface, std::uint32_t seed)
{
  const RoadPoint& road = surface.road;
  const double t = std::abs(road.t);
  const bool centre_line = t < 0.07 && fraction(road.s / 4.5) < 0.5;
  const bool parking_line = std::abs(t - 3.05) < 0.05 ||
                            (t > 3.05 && t < 4.9 && fraction(road.s / 6.0) < 0.015);
  const double worn = 0.7 + 0.3 * valueNoise(surface.point * 3.0, seed + 1);
  if (centre_line || parking_line)
    return Vector3f::Constant(static_cast<float>(0.55 * worn));
  // Repaired patches, wheel tracks and the seam of the gutter.
  const Cell patch = cellOf(road.s, road.t + 20.0, 5.5, 2.6, seed);
  double grey = 0.135 + 0.02 * valueNoise(surface.point * 0.25, seed + 2);
  if (patch.number % 6 == 0 && patch.u > 1.0 && patch.v > 0.7)
    grey *= 0.72;
  if (t > RoadLine::half_width - 0.3)
    grey *= 1.3;
  const double lane = std::abs(std::abs(road.t) - 1.6);
  grey *= 1.0 - 0.12 * std::max(0.0, 1.0 - std::abs(lane - 0.75) / 0.3);
  return Vector3f(1.0f, 1.0f, 1.04f) * static_cast<float>(grey);
}

Vector3f
paving(const Surface& surface, double footprint, std::uint32_t seed)
{
  const double across = std::abs(surface.road.t);
  if (across < RoadLine::half_width + 0.16) // kerb stones
    return Vector3f::Constant(
        fraction(surface.road.s) < 0.03 && resolved(0.03, footprint) ? 0.22f : 0.42f);
  const Cell slab = cellOf(surface.road.s, surface.road.t, 0.5, 0.5, seed + 5);
  double grey = 0.30 + 0.045 * (slab.number % 16) / 16.0;
  if (resolved(0.04, footprint) && (slab.u < 0.02 || slab.v < 0.02))
    grey *= 0.55;
  return Vector3f(1.0f, 0.96f, 0.88f) * static_cast<float>(grey);
}

Vector3f
grass(const Surface& surface, std::uint32_t seed)
{
  const float dry =
      static_cast<float>(0.5 + 0.5 * valueNoise(surface.point * 0.35, seed + 7));
  return Vector3f(0.13f + 0.07f * dry, 0.21f, 0.07f);
}

Vector3f
windowColour(const Cell& cell, double width, double height)
{
  const double u = std::min(cell.u, width - cell.u);
  const double v = std::min(cell.v, height - cell.v);
  if (u < 0.08 || v < 0.08 || std::abs(cell.u - 0.5 * width) < 0.035)
    return Vector3f::Constant(0.6f); // frame
  const bool curtain = cell.number % 3 == 0 && u < 0.3;
  const float glass = static_cast<float>(0.05 + 0.10 * cell.v / height);
  return curtain ? Vector3f(0.45f, 0.43f, 0.38f)
                 : Vector3f(0.8f * glass, 0.95f * glass, 1.1f * glass);
}

/** \brief Windows in rows with their sills, and a door in the middle of the front.
 * \param[in] u along the wall, 0 to \a length [m]
 * \param[in] v height above the ground [m]
 * \return whether this point is part of one */
bool
opening(const Primitive& house, bool front, double u, double v, double length,
        Vector3f& c)
{
  const double from_door = std::abs(u - 0.5 * length);
  if (front && from_door < 0.55 && v < 2.25) {
    c = Vector3f(0.16f, 0.09f, 0.06f);
    return true;
  }
  if ((front && v < 2.9 && from_door < 1.2) || v < 0.95 ||
      v > 2.0 * house.half.z() - 1.0)
    return false;
  const int columns = std::max(1, static_cast<int>(length / 2.7));
  Cell cell = cellOf(u, v - 0.95, length / columns, 2.9, house.id);
  cell.u -= 0.5 * length / columns - 0.55;
  if (cell.v < 1.35 && cell.u > 0.0 && cell.u < 1.1)
    c = windowColour(cell, 1.1, 1.35);
  else if (cell.v < 0.1 && cell.u > -0.12 && cell.u < 1.22)
    c = house.colour * 0.6f;
  else
    return false;
  return true;
}

/** \brief Plaster or bricks around the openings. */
Vector3f
wall(const Surface& surface, double footprint)
{
  const Primitive& house = *surface.solid;
  const bool front = std::abs(surface.local_normal.y()) > 0.5;
  const double length = 2.0 * (front ? house.half.x() : house.half.y());
  const double u = (front ? surface.local.x() : surface.local.y()) + 0.5 * length;
  const double v = surface.local.z() + house.half.z();
  Vector3f colour;
  if (house.half.z() > 1.5 && opening(house, front, u, v, length, colour))
    return colour;
  const double stain = 0.06 * valueNoise(surface.local * 0.8, house.id);
  colour = house.colour * static_cast<float>(1.0 + stain);
  if (house.id % 3 == 0 && resolved(0.06, footprint)) {
    const double row = std::floor(v / 0.085);
    const Cell brick =
        cellOf(u + 0.125 * (static_cast<int>(row) & 1), v, 0.25, 0.085, house.id);
    colour *= brick.u < 0.018 || brick.v < 0.014
                  ? 1.25f
                  : 0.8f + 0.3f * float(brick.number % 8) / 8.0f;
  }
  return colour;
}

Vector3f
roof(const Surface& surface, double footprint)
{
  if (std::abs(surface.local_normal.z()) < 0.2) // the gable
    return Vector3f(0.42f, 0.36f, 0.28f);
  const bool across = std::abs(surface.local_normal.x()) > 0.2;
  const double u = across ? surface.local.y() : surface.local.x();
  const Cell tile = cellOf(u, surface.local.z(), 0.3, 0.22, surface.id);
  float light = 0.85f + 0.3f * float(tile.number % 8) / 8.0f;
  if (resolved(0.08, footprint) && tile.v < 0.05)
    light *= 0.6f;
  return surface.solid->colour * light;
}

Vector3f
boards(const Surface& surface, double footprint)
{
  const Cell board = cellOf(surface.local.x() + 50.0, 0.0, 0.14, 1.0, surface.id);
  float light = 0.75f + 0.5f * float(board.number % 16) / 16.0f;
  if (resolved(0.025, footprint) && board.u < 0.02)
    light *= 0.35f;
  const double from_top = surface.solid->half.z() - surface.local.z();
  if (std::abs(from_top - 0.18) < 0.04)
    light *= 0.6f;
  return surface.solid->colour * light;
}

Vector3f
carBody(const Surface& surface)
{
  const Primitive& body = *surface.solid;
  const bool end = std::abs(surface.local_normal.x()) > 0.7;
  const double y = std::abs(surface.local.y());
  if (end && body.half.z() > 0.2) {
    if (surface.local.z() > 0.02 && y > body.half.y() - 0.32)
      return surface.local.x() > 0.0 ? Vector3f(0.5f, 0.03f, 0.03f)
                                     : Vector3f(0.7f, 0.7f, 0.65f); // lights
    if (std::abs(surface.local.z()) < 0.06 && y < 0.26)
      return Vector3f(0.6f, 0.6f, 0.5f); // number plate
  }
  if (surface.local.z() < -body.half.z() + 0.07 && body.half.z() > 0.2)
    return Vector3f::Constant(0.03f); // sill
  const bool seam = !end && std::abs(std::abs(surface.local.x()) - 0.45) < 0.012;
  return body.colour * (seam ? 0.4f : 1.0f);
}

Vector3f
carCabin(const Surface& surface)
{
  const Primitive& cabin = *surface.solid;
  if (surface.local_normal.z() > 0.9)
    return cabin.colour;
  const double up = surface.local.z() / cabin.half.z(); // -1..1
  const bool end = std::abs(surface.local_normal.x()) > 0.5;
  const double lean = (end ? cabin.taper.y() : cabin.taper.x()) * 0.5 * (up + 1.0);
  const double half = (end ? cabin.half.y() : cabin.half.x()) - lean;
  const double u = std::abs(end ? surface.local.y() : surface.local.x());
  const bool pillar = half - u < 0.08 || (!end && u < 0.04);
  if (up > 0.82 || up < -0.85 || pillar)
    return cabin.colour;
  return Vector3f(0.035f, 0.042f, 0.05f) * static_cast<float>(1.4 + up);
}

Vector3f
sign(const Surface& surface)
{
  const Primitive& plate = *surface.solid;
  const double y = surface.local.y() / plate.half.y();
  const double z = surface.local.z() / plate.half.z();
  if (surface.local_normal.x() > 0.5)
    return Vector3f::Constant(0.3f); // the back
  const double reach = plate.shape == Shape::ellipsoid
                           ? std::sqrt(y * y + z * z)
                           : std::max(std::abs(y), std::abs(z));
  const bool symbol = (std::abs(y) < 0.14 && std::abs(z) < 0.45) ||
                      (std::abs(y) < 0.4 && std::abs(z - 0.15) < 0.13);
  const bool red = plate.colour.x() > plate.colour.z();
  if (red)
    return reach > 0.74 ? plate.colour
                        : (symbol ? Vector3f(0.05f, 0.05f, 0.05f)
                                  : Vector3f(0.75f, 0.75f, 0.75f));
  return symbol || (reach > 0.85 && reach < 0.94) ? Vector3f(0.75f, 0.75f, 0.75f)
                                                  : plate.colour;
}

Vector3f
plainColour(const Surface& surface, double footprint, std::uint32_t seed)
{
  switch (surface.material) {
  case Material::asphalt:
    return asphalt(surface, seed);
  case Material::paving:
    return paving(surface, footprint, seed);
  case Material::kerb:
    return Vector3f::Constant(0.36f);
  case Material::grass:
    return grass(surface, seed);
  case Material::wall:
    return wall(surface, footprint);
  case Material::roof:
    return roof(surface, footprint);
  case Material::boards:
    return boards(surface, footprint);
  case Material::car_body:
    return carBody(surface);
  case Material::car_cabin:
    return carCabin(surface);
  case Material::sign:
    return sign(surface);
  default:
    return surface.solid->colour;
  }
}

/** \brief Variation of the brightness by the grain, in the order of Material. */
constexpr std::array<double, 15> kGrain{0.30, 0.22, 0.15, 0.45, 0.13, 0.22, 0.22, 0.5,
                                        0.75, 0.06, 0.06, 0.15, 0.15, 0.15, 0.15};

} // namespace

Vector3f
surfaceColour(const Surface& surface, double footprint, std::uint32_t seed)
{
  const Vector3f colour = plainColour(surface, footprint, seed);
  const Vector3d& p = surface.solid ? surface.local : surface.point;
  const double detail = detailNoise(p, footprint, seed + surface.id);
  return colour *
         static_cast<float>(1.0 + kGrain[static_cast<int>(surface.material)] * detail);
}

} // namespace pcl_semantic::synthetic
