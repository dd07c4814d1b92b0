// SPDX-License-Identifier: BSD-3-Clause
#include "room_renderer.h"

#include "materials.h"
#include "noise.h"
#include "ray_image.h"

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic {

using Eigen::Vector3d;
using Eigen::Vector3f;
using synthetic::Sample;
using synthetic::Surface;

RoomRenderer::RoomRenderer(const SyntheticRoom& room, int width, int height,
                           synthetic::Lens lens)
    : room_(room), lens_(lens)
{
  synthetic::requireImageSize(width, height);
  const double focal_length = synthetic::focalFactor(lens) * 585.0 * width / 640.0;
  camera_ = {focal_length, focal_length, 0.5 * width, 0.5 * height, 1.0, width, height};
}

RoomView
RoomRenderer::render(int frame) const
{
  RoomView view;
  view.frame = frame;
  view.camera = camera_;
  view.T_world_camera = room_.pose(frame);
  const auto look = [&](double u, double v) {
    Surface surface;
    Sample sample;
    sample.id = 1;
    const Eigen::Vector2d pixel = synthetic::pinholePixel(lens_, camera_, u, v);
    // Depth 1 along the optical axis, so that the distance of a hit is its depth.
    const Vector3d direction =
        view.T_world_camera.linear() * camera_.unproject(pixel.x(), pixel.y(), 1.0);
    if (!room_.nearest({view.T_world_camera.translation(), direction}, surface))
      return sample;
    sample.depth = surface.distance;
    sample.id = surface.id;
    sample.label = surface.label;
    const float lamp = static_cast<float>(room_.lampLight(surface));
    const float ambient =
        static_cast<float>(0.45 + 0.1 * surface.normal.z() + 0.05 * surface.normal.x());
    const double footprint = surface.distance / camera_.fx;
    sample.light = synthetic::surfaceColour(surface, footprint, room_.seed())
                       .cwiseProduct(Vector3f(1.0f, 0.98f, 0.94f) * ambient +
                                     Vector3f(1.1f, 1.0f, 0.85f) * lamp);
    return sample;
  };
  std::vector<Sample> samples;
  view.colour =
      synthetic::renderRays(look, camera_.width, camera_.height,
                            synthetic::hash(room_.seed(), frame, 0x200), samples);
  view.depth.create(camera_.height, camera_.width, CV_32FC1);
  view.labels.create(camera_.height, camera_.width, CV_8UC1);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    view.depth.ptr<float>()[i] = static_cast<float>(samples[i].depth);
    view.labels.ptr<Label>()[i] = samples[i].label;
  }
  return view;
}

cv::Mat
measuredDepth(const RoomView& view, std::uint32_t seed, double scale)
{
  cv::Mat measured(view.depth.size(), CV_16UC1);
  const std::uint32_t frame_seed = synthetic::hash(seed, view.frame, 0xdeb);
  for (std::size_t i = 0; i < measured.total(); ++i) {
    const double z = view.depth.ptr<float>()[i];
    // The sum of twelve uniform numbers is nearly normal, and needs no logarithm, which
    // differs between machines.
    double normal = -6.0;
    for (std::uint32_t k = 0; k < 12; ++k)
      normal += synthetic::uniform(frame_seed, std::uint32_t(i), k);
    const double deviation = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    measured.ptr<std::uint16_t>()[i] = cv::saturate_cast<std::uint16_t>(
        1000.0 * (z > 0.0 ? z + scale * deviation * normal : 0.0));
  }
  return measured;
}

} // namespace pcl_semantic
