// SPDX-License-Identifier: BSD-3-Clause
#include "surface.h"

namespace pcl_semantic::synthetic {

bool
nearestSolid(const BoxTree& solids, const Ray& ray, Surface& surface)
{
  const Primitive* solid = solids.nearest(ray, surface.distance, surface.local_normal);
  if (!solid)
    return false;
  surface.solid = solid;
  surface.label = solid->label;
  surface.material = solid->material;
  surface.id = solid->id;
  surface.point = ray.origin + surface.distance * ray.direction;
  surface.local = solid->toLocal(surface.point - solid->centre);
  surface.normal = solid->toWorld(surface.local_normal);
  return true;
}

} // namespace pcl_semantic::synthetic
