// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_street.h"

#include "synthetic_objects.h"

#include <pcl_semantic/dataset/synthetic_scene.h>

#include <cmath>

namespace pcl_semantic::synthetic {

namespace {

constexpr double kLengthAhead = 110.0; // street beyond the last camera [m]

} // namespace

Street::Street(std::uint32_t seed, double length)
    : seed_(seed), road_({0.0, -lane}, length + kLengthAhead, seed),
      solids_(buildStreet(road_, length + kLengthAhead, seed))
{}

bool
Street::nearest(const Ray& ray, Surface& surface) const
{
  surface.distance = sight / ray.direction.norm();
  const bool ground = nearestGround(ray, surface);
  const Primitive* solid = solids_.nearest(ray, surface.distance, surface.local_normal);
  if (solid) {
    surface.solid = solid;
    surface.label = solid->label;
    surface.material = solid->material;
    surface.id = solid->id;
    surface.point = ray.origin + surface.distance * ray.direction;
    surface.local = solid->toLocal(surface.point - solid->centre);
    surface.normal = solid->toWorld(surface.local_normal);
  }
  return ground || solid;
}

bool
Street::nearestGround(const Ray& ray, Surface& surface) const
{
  // The sidewalk's plane comes first; where it is above the road the ray goes on down.
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
  double sine = 0.0;
  double cosine = 0.0;
  sinCos(road_.heading(surface.road.s), sine, cosine);
  const double side = surface.road.t > 0.0 ? -1.0 : 1.0;
  surface.normal = surface.local_normal = side * Eigen::Vector3d(-sine, cosine, 0.0);
}

} // namespace pcl_semantic::synthetic
