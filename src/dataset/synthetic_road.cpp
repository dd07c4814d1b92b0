// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_road.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic::synthetic {

namespace {

Eigen::Vector2d
unit(double angle)
{
  Eigen::Vector2d direction;
  sinCos(angle, direction.y(), direction.x());
  return direction;
}

Eigen::Vector2d
leftOf(const Eigen::Vector2d& direction)
{
  return {-direction.y(), direction.x()};
}

} // namespace

RoadLine::RoadLine(const Eigen::Vector2d& start, double length, std::uint32_t seed)
{
  Random random(seed, 0x40ad);
  Piece first;
  first.s = -60.0;
  first.length = 60.0 + random.uniform(7.0, 10.0);
  first.start = start + Eigen::Vector2d(first.s, 0.0);
  first.along = {1.0, 0.0};
  pieces_.push_back(first);
  double side = random.chance(0.5) ? 1.0 : -1.0;
  while (pieces_.back().s < length) {
    const double turn = random.uniform(0.75, 1.0);
    const double radius = random.uniform(38.0, 44.0);
    append(turn * radius, side / radius);
    append(random.uniform(15.0, 30.0), 0.0);
    side = -side;
    append(turn * radius, side / radius); // back to the first heading
    append(random.uniform(15.0, 30.0), 0.0);
    if (random.chance(0.5))
      side = -side;
  }
}

void
RoadLine::append(double length, double curvature)
{
  const Piece& last = pieces_.back();
  Piece piece;
  piece.s = last.s + last.length;
  piece.length = length;
  piece.curvature = curvature;
  piece.start = position({piece.s, 0.0});
  piece.heading = last.heading + last.length * last.curvature;
  piece.along = unit(piece.heading);
  pieces_.push_back(piece);
}

const RoadLine::Piece&
RoadLine::pieceAt(double s) const
{
  const auto after = std::upper_bound(
      pieces_.begin() + 1, pieces_.end(), s,
      [](double value, const Piece& piece) { return value < piece.s; });
  return *(after - 1);
}

Eigen::Vector2d
RoadLine::position(const RoadPoint& point) const
{
  const Piece& piece = pieceAt(point.s);
  const double run = point.s - piece.s;
  if (piece.curvature == 0.0)
    return piece.start + run * piece.along + point.t * leftOf(piece.along);
  const double radius = 1.0 / piece.curvature;
  const Eigen::Vector2d centre = piece.start + radius * leftOf(piece.along);
  return centre -
         (radius - point.t) * leftOf(unit(piece.heading + run * piece.curvature));
}

double
RoadLine::heading(double s) const
{
  const Piece& piece = pieceAt(s);
  return piece.heading + (s - piece.s) * piece.curvature;
}

double
RoadLine::curvature(double s) const
{
  return pieceAt(s).curvature;
}

RoadPoint
RoadLine::locateOn(const Piece& piece, const Eigen::Vector2d& position) const
{
  const Eigen::Vector2d offset = position - piece.start;
  if (piece.curvature == 0.0)
    return {piece.s + offset.dot(piece.along), offset.dot(leftOf(piece.along))};
  // Seen from the centre of the arc: across points away from it for a right turn.
  const double radius = 1.0 / piece.curvature;
  const Eigen::Vector2d from_centre = offset - radius * leftOf(piece.along);
  const double side = radius > 0.0 ? 1.0 : -1.0;
  const double angle = std::atan2(from_centre.dot(piece.along),
                                  -side * from_centre.dot(leftOf(piece.along)));
  return {piece.s + angle * std::abs(radius), radius - side * from_centre.norm()};
}

RoadPoint
RoadLine::locate(const Eigen::Vector2d& position) const
{
  // Headings stay within a right angle of +x, so the pieces are in the order of x.
  const auto after = std::upper_bound(
      pieces_.begin(), pieces_.end(), position.x(),
      [](double x, const Piece& piece) { return x < piece.start.x(); });
  const auto index = after - pieces_.begin();
  const auto first = std::max<std::ptrdiff_t>(index - 4, 0);
  const auto last = std::min<std::ptrdiff_t>(index + 3, pieces_.size());
  RoadPoint best;
  double best_distance = std::numeric_limits<double>::infinity();
  for (auto i = first; i < last; ++i) {
    const RoadPoint point = locateOn(pieces_[i], position);
    const bool is_first = i == 0;
    const bool is_last = i + 1 == static_cast<std::ptrdiff_t>(pieces_.size());
    const bool inside = (is_first || point.s >= pieces_[i].s - 1e-9) &&
                        (is_last || point.s <= pieces_[i].s + pieces_[i].length + 1e-9);
    if (inside && std::abs(point.t) < best_distance) {
      best_distance = std::abs(point.t);
      best = point;
    }
  }
  if (std::isinf(best_distance))
    best = {0.0, 1e6};
  return best;
}

} // namespace pcl_semantic::synthetic
