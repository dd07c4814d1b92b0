// SPDX-License-Identifier: BSD-3-Clause
#include "renderer.h"

#include "materials.h"
#include "ray_image.h"

#include <opencv2/core.hpp>

#include <cmath>
#include <vector>

namespace pcl_semantic {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using synthetic::Ray;
using synthetic::Sample;
using synthetic::Street;
using synthetic::Surface;

/** \brief One camera looking at the street. */
class Eye {
public:
  Eye(const Street& street, const StereoCamera& camera, const Eigen::Isometry3d& pose)
      : street_(street), camera_(camera), pose_(pose)
  {
    const std::uint32_t seed = street.seed();
    const double side = synthetic::uniform(seed, 0x50a) < 0.5 ? 1.0 : -1.0;
    to_sun_ =
        Vector3d(-0.45, side * (0.5 + 0.4 * synthetic::uniform(seed, 0x50b)), 0.72)
            .normalized();
  }

  /** \brief Casts one ray through pixel coordinates. */
  Sample
  look(double u, double v) const
  {
    // Depth 1 along the optical axis, so that the distance of a hit is its depth.
    const Ray ray{pose_.translation(), pose_.linear() * camera_.unproject(u, v, 1.0)};
    Surface surface;
    Sample sample;
    if (!street_.nearest(ray, surface)) {
      sample.id = 1;
      sample.label = synthetic_sky;
      sample.light = synthetic::skyColour(ray.direction.normalized(), street_.seed());
      return sample;
    }
    sample.depth = surface.distance;
    sample.id = surface.id;
    sample.label = surface.label;
    sample.object = surface.solid ? surface.solid->object : 0;
    sample.light = shade(surface);
    return sample;
  }

private:
  Vector3f
  shade(const Surface& surface) const
  {
    const double footprint = surface.distance / camera_.fx;
    const Vector3f colour =
        synthetic::surfaceColour(surface, footprint, street_.seed());
    const double facing = surface.normal.dot(to_sun_);
    const Vector3d start = surface.point + 0.02 * surface.normal;
    const bool lit = facing > 0.0 && !street_.inShadow(start, to_sun_);
    const float direct = lit ? static_cast<float>(facing) : 0.0f;
    const float ambient = static_cast<float>(0.36 + 0.12 * surface.normal.z());
    const Vector3f light = Vector3f(0.88f, 0.97f, 1.12f) * ambient +
                           Vector3f(1.42f, 1.34f, 1.18f) * direct;
    const float haze =
        static_cast<float>(surface.distance / (surface.distance + 420.0));
    return colour.cwiseProduct(light) * (1.0f - haze) +
           Vector3f(0.62f, 0.70f, 0.78f) * haze;
  }

  const Street& street_;
  const StereoCamera& camera_;
  Eigen::Isometry3d pose_;
  Vector3d to_sun_;
};

} // namespace

SyntheticRenderer::SyntheticRenderer(const SyntheticScene& scene, int width, int height,
                                     synthetic::Lens lens)
    : scene_(scene), lens_(lens)
{
  synthetic::requireImageSize(width, height);
  const double focal_length = synthetic::focalFactor(lens) * 718.0 * width / 1241.0;
  camera_ = {
      focal_length, focal_length, 607.0 * width / 1241.0, 185.0 * height / 376.0, 0.54,
      width,        height};
}

Eigen::Isometry3d
SyntheticRenderer::pose(int frame) const
{
  return scene_.pose(frame) * Eigen::Translation3d(camera_2_offset, 0.0, 0.0);
}

SyntheticView
SyntheticRenderer::render(int frame) const
{
  return render(frame, pose(frame));
}

SyntheticView
SyntheticRenderer::render(int frame, const Eigen::Isometry3d& T_world_camera) const
{
  SyntheticView view;
  view.frame = frame;
  view.camera = camera_;
  view.T_world_camera = T_world_camera;
  const Eigen::Isometry3d right_pose =
      view.T_world_camera * Eigen::Translation3d(camera_.baseline, 0.0, 0.0);
  const std::uint32_t noise = synthetic::hash(scene_.seed(), frame, 0xca3);
  std::vector<Sample> samples;
  const Street street = scene_.street(frame);
  const auto image = [&](const Eigen::Isometry3d& pose, std::uint32_t noise_seed) {
    const Eye eye(street, camera_, pose);
    const auto look = [&](double u, double v) {
      const Eigen::Vector2d pixel = synthetic::pinholePixel(lens_, camera_, u, v);
      return eye.look(pixel.x(), pixel.y());
    };
    return synthetic::renderRays(look, camera_.width, camera_.height, noise_seed,
                                 samples);
  };
  view.right = image(right_pose, noise + 1);
  view.left = image(view.T_world_camera, noise); // its samples last: they are the truth
  view.disparity.create(camera_.height, camera_.width, CV_32FC1);
  view.labels.create(camera_.height, camera_.width, CV_8UC1);
  view.objects.create(camera_.height, camera_.width, CV_32SC1);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double depth = samples[i].depth;
    const double disparity = depth > 0.0 ? camera_.fx * camera_.baseline / depth : 0.0;
    view.disparity.ptr<float>()[i] = static_cast<float>(disparity);
    view.labels.ptr<Label>()[i] = samples[i].label;
    view.objects.ptr<int>()[i] = samples[i].object;
  }
  return view;
}

} // namespace pcl_semantic
