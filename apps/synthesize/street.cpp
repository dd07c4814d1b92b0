// SPDX-License-Identifier: BSD-3-Clause
#include "street.h"

#include "core/fail.h"
#include "objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace pcl_semantic::synthetic {

namespace {

constexpr double kLengthAhead = 110.0; // street beyond the last camera [m]

Eigen::Vector2d
unit(double angle)
{
  const auto [sine, cosine] = sinCos(angle);
  return {cosine, sine};
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
  // Seen from the centre of the arc; for a right turn the direction is reversed.
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
  // Headings stay within a right angle of +x, so the sections are sorted by x.
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

Street::Street(std::uint32_t seed, double length, int first_object)
    : seed_(seed), length_(length + kLengthAhead), road_({0.0, -lane}, length_, seed),
      standing_(
          std::make_shared<BoxTree>(buildStreet(road_, length_, seed, first_object))),
      driving_({})
{}

Street
Street::withTraffic(const std::vector<DrivingCar>& traffic, int frame) const
{
  Street street = *this;
  street.driving_ = BoxTree(buildTraffic(road_, length_, seed_, traffic, frame));
  return street;
}

bool
Street::nearest(const Ray& ray, Surface& surface) const
{
  surface.distance = sight / ray.direction.norm();
  const bool ground = nearestGround(ray, surface);
  if (!ground)
    surface.solid = nullptr;
  nearestSolid(*standing_, ray, surface);
  nearestSolid(driving_, ray, surface);
  return ground || surface.solid;
}

bool
Street::nearestGround(const Ray& ray, Surface& surface) const
{
  // The sidewalk's plane is hit first. Above the road the ray continues downward.
  const double height = ray.origin.z() - road_height;
  if (ray.direction.z() >= 0.0 || height < RoadLine::kerb_height)
    return false;
  const double above = (height - RoadLine::kerb_height) / -ray.direction.z();
  if (above >= surface.distance)
    return false;
  surface.solid = nullptr;
  surface.id = 0;
  surface.normal = surface.local_normal = Eigen::Vector3d::UnitZ();
  surface.distance = above;
  surface.point = ray.origin + above * ray.direction;
  surface.road = road_.locate(surface.point.head<2>());
  if (std::abs(surface.road.t) >= RoadLine::half_width) {
    const bool paved = std::abs(surface.road.t) < RoadLine::sidewalk_end;
    surface.label = paved ? synthetic_sidewalk : synthetic_vegetation;
    surface.material = paved ? Material::paving : Material::grass;
    return true;
  }
  const double below = height / -ray.direction.z();
  surface.distance = below;
  surface.point = ray.origin + below * ray.direction;
  surface.road = road_.locate(surface.point.head<2>());
  surface.label = synthetic_road;
  surface.material = Material::asphalt;
  if (std::abs(surface.road.t) > RoadLine::half_width)
    hitKerb(ray, above, below, surface);
  return true;
}

void
Street::hitKerb(const Ray& ray, double above, double below, Surface& surface) const
{
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (above + below);
    const Eigen::Vector3d p = ray.origin + middle * ray.direction;
    const bool over_road = std::abs(road_.locate(p.head<2>()).t) < RoadLine::half_width;
    (over_road ? above : below) = middle;
  }
  surface.distance = below;
  surface.point = ray.origin + below * ray.direction;
  surface.road = road_.locate(surface.point.head<2>());
  surface.label = synthetic_sidewalk;
  surface.material = Material::kerb;
  const auto [sine, cosine] = sinCos(road_.heading(surface.road.s));
  const double side = surface.road.t > 0.0 ? -1.0 : 1.0;
  surface.normal = surface.local_normal = side * Eigen::Vector3d(-sine, cosine, 0.0);
}

} // namespace pcl_semantic::synthetic

namespace pcl_semantic {

namespace {

using synthetic::sinCos;

/** \brief Rotates camera axes (x right, y down, z forward) to the world's. */
Eigen::Matrix3d
worldFromCamera()
{
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return rotation;
}

/** \brief Rotation about the vertical (to the left), then nose down, world axes. */
Eigen::Matrix3d
turn(double heading, double pitch)
{
  const auto [s, c] = sinCos(heading);
  const auto [sp, cp] = sinCos(pitch);
  Eigen::Matrix3d yaw;
  yaw << c, -s, 0, s, c, 0, 0, 0, 1;
  Eigen::Matrix3d nod;
  nod << cp, 0, sp, 0, 1, 0, -sp, 0, cp;
  return yaw * nod;
}

} // namespace

std::vector<DrivingCar>
makeTraffic(int cars)
{
  if (cars < 0 || cars > 1000)
    fail<InvalidParameterException>("driving cars (--traffic): got ", cars,
                                    ", expected 0 to 1000");
  std::vector<DrivingCar> traffic;
  for (int car = 0; car < cars; ++car) {
    const int row = car / 2;
    const double lane = synthetic::Street::lane;
    if (car % 2 == 0) // ahead of the camera
      traffic.push_back({{12.0 + 15.0 * row, lane}, 1.0});
    else
      traffic.push_back({{40.0 + 20.0 * row, -lane}, -0.9});
  }
  return traffic;
}

double
SyntheticCar::distance(const Eigen::Vector3d& point) const
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const synthetic::Primitive& part : parts) {
    Eigen::Vector3d half = part.half;
    half.head<2>() -= part.taper.cwiseMin(0.0); // wider at the top
    const Eigen::Vector3d beyond = part.toLocal(point - part.centre).cwiseAbs() - half;
    nearest = std::min(nearest, beyond.cwiseMax(0.0).norm());
  }
  return nearest;
}

SyntheticScene::SyntheticScene(std::uint32_t seed, int frames,
                               std::vector<DrivingCar> traffic)
    : frames_(frames), traffic_(std::move(traffic))
{
  if (frames < 1 || frames > 100000)
    fail<InvalidParameterException>("frames of a synthetic scene: ", frames,
                                    ", expected 1 to 100000");
  for (const auto& [start, speed] : traffic_)
    if (!std::isfinite(start.s) || !std::isfinite(start.t) || !std::isfinite(speed))
      fail<InvalidParameterException>("a driving car: got s ", start.s, ", t ", start.t,
                                      ", speed ", speed, ", expected finite numbers");
  street_ = std::make_shared<synthetic::Street>(seed, frames * metres_per_frame,
                                                int(traffic_.size()) + 1);
}

void
SyntheticScene::checkFrame(int frame) const
{
  if (frame < 0 || frame >= frames_)
    fail<InvalidParameterException>("frame ", frame, " of a synthetic scene with ",
                                    frames_, " frames");
}

synthetic::Street
SyntheticScene::street(int frame) const
{
  checkFrame(frame);
  return street_->withTraffic(traffic_, frame);
}

std::vector<SyntheticCar>
SyntheticScene::cars(int frame) const
{
  const synthetic::Street street = this->street(frame);
  std::map<int, SyntheticCar> cars;
  for (const auto* parts : {&street.driving(), &street.standing()})
    for (const synthetic::Primitive& part : *parts)
      if (part.label == synthetic_car) {
        SyntheticCar& car = cars[part.object];
        car.object = part.object;
        car.is_driving = parts == &street.driving();
        car.parts.push_back(part);
      }
  std::vector<SyntheticCar> sorted;
  for (auto& [object, car] : cars)
    sorted.push_back(std::move(car));
  return sorted;
}

Eigen::Isometry3d
SyntheticScene::pose(int frame) const
{
  checkFrame(frame);
  // A car weaves, pitches and bounces smoothly, with no deviation in frame 0.
  const double weave = sinCos(2.0 * (frame % 31) * M_PI / 31.0 - M_PI).second;
  const double nod = sinCos(2.0 * (frame % 9) * M_PI / 9.0 - M_PI).first;
  const synthetic::RoadLine& road = street_->road();
  const synthetic::RoadPoint position{frame * metres_per_frame,
                                      synthetic::Street::lane + 0.1 * (1.0 + weave)};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn(road.heading(position.s), 0.004 * nod) * worldFromCamera();
  pose.translation().head<2>() = road.position(position);
  pose.translation().z() = 0.008 * nod;
  if (frame == 0) { // exactly the origin, without rounding errors
    pose.linear() = worldFromCamera();
    pose.translation().setZero();
  }
  return pose;
}

Eigen::Isometry3d
SyntheticScene::kittiPose(int frame) const
{
  return pose(0).inverse() * pose(frame);
}

SyntheticHit
SyntheticScene::intersect(const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction) const
{
  SyntheticHit hit;
  synthetic::Surface surface;
  if (!street_->nearest({origin, direction}, surface)) {
    hit.distance = std::numeric_limits<double>::infinity();
    return hit;
  }
  hit.label = surface.label;
  hit.distance = surface.distance;
  hit.point = surface.point;
  return hit;
}

} // namespace pcl_semantic
