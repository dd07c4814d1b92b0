// SPDX-License-Identifier: BSD-3-Clause
#include "keyframe_window.h"

#include <algorithm>
#include <map>
#include <utility>

namespace pcl_semantic::odometry {

namespace {

constexpr double kOutlier = 16.0; // squared whitened residual
constexpr double kFewLeft = 0.7;  // fraction of the last keyframe's tracks
constexpr double kMedian = 2.366; // of the chi-squared distribution with 3 degrees of
                                  // freedom

// The upper median; \a values must not be empty.
double
median(std::vector<double> values)
{
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace

int
KeyframeWindow::indexOf(int number) const
{
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i].number == number)
      return int(i);
  return -1;
}

// Collects points and their measurements; anchors outside the window are fixed.
std::vector<std::size_t>
KeyframeWindow::collect(WindowAdjustment& adjustment) const
{
  for (const Frame& frame : frames)
    adjustment.frames.push_back({frame.T_camera_world, false});
  adjustment.frames.front().is_fixed = true;
  std::map<int, int> old_anchors;
  std::vector<std::size_t> adjusted;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const FeatureTrack& track = tracks[i];
    if (track.sightings.empty())
      continue;
    int anchor = indexOf(track.anchor);
    if (anchor < 0) {
      const auto [old, is_new] =
          old_anchors.emplace(track.anchor, int(adjustment.frames.size()));
      if (is_new)
        adjustment.frames.push_back({track.T_world_anchor.inverse(), true});
      anchor = old->second;
    }
    const int point = int(adjustment.points.size());
    adjustment.points.push_back({track.position, anchor, track.anchor_disparity});
    for (const FeatureTrack::Sighting& sighting : track.sightings)
      adjustment.measurements.push_back({point, indexOf(sighting.frame), sighting.uvd});
    adjusted.push_back(i);
  }
  return adjusted;
}

// Returns the median squared error.
double
KeyframeWindow::rejectOutliers(const WindowAdjustment& adjustment,
                               const std::vector<std::size_t>& adjusted)
{
  std::vector<double> errors;
  for (const WindowAdjustment::Measurement& measurement : adjustment.measurements) {
    errors.push_back(adjustment.squaredError(measurement));
    if (errors.back() > kOutlier) {
      FeatureTrack& track = tracks[adjusted[std::size_t(measurement.point)]];
      track.is_alive = false;
      track.sightings.clear();
    }
  }
  if (errors.empty())
    return kMedian;
  return median(std::move(errors));
}

Matrix6d
KeyframeWindow::adjust(int iterations)
{
  WindowAdjustment adjustment;
  adjustment.camera = camera_;
  adjustment.noise = noise_;
  const std::vector<std::size_t> adjusted = collect(adjustment);
  adjustment.offset = adjustment.offset_before = offset;
  adjustment.offset_deviation = offset_deviation;
  adjustment.solve(iterations);
  offset = adjustment.offset;
  for (std::size_t i = 0; i < frames.size(); ++i)
    frames[i].T_camera_world = adjustment.frames[i].T_camera_world;
  for (std::size_t i = 0; i < adjusted.size(); ++i)
    tracks[adjusted[i]].position = adjustment.points[i].position;
  for (FeatureTrack& track : tracks) {
    const int anchor = indexOf(track.anchor);
    if (anchor >= 0)
      track.T_world_anchor = frames[std::size_t(anchor)].T_camera_world.inverse();
  }
  const double noise = rejectOutliers(adjustment, adjusted) / kMedian;
  return noise * adjustment.covariance(int(frames.size()) - 1);
}

bool
KeyframeWindow::newestBringsMuch(double flow) const
{
  const int newest = frames.back().number;
  const int last = frames[frames.size() - 2].number;
  std::vector<double> ways;
  std::size_t before = 0;
  for (const FeatureTrack& track : tracks) {
    const auto& sightings = track.sightings;
    const Eigen::Vector3d first(camera_.fx * track.position.ray.x() + camera_.cx,
                                camera_.fy * track.position.ray.y() + camera_.cy, 0.0);
    const Eigen::Vector3d* then = track.anchor == last ? &first : nullptr;
    for (const FeatureTrack::Sighting& sighting : sightings)
      if (sighting.frame == last)
        then = &sighting.uvd;
    before += then != nullptr;
    if (then && !sightings.empty() && sightings.back().frame == newest)
      ways.push_back((sightings.back().uvd - *then).head<2>().norm());
  }
  if (ways.empty() || double(ways.size()) < kFewLeft * double(before))
    return true;
  return median(std::move(ways)) > flow;
}

void
KeyframeWindow::dropNewest()
{
  const int number = frames.back().number;
  frames.pop_back();
  for (FeatureTrack& track : tracks)
    if (!track.sightings.empty() && track.sightings.back().frame == number)
      track.sightings.pop_back();
}

void
KeyframeWindow::shrink(std::size_t count)
{
  if (frames.size() > count)
    frames.erase(frames.begin(), frames.end() - std::ptrdiff_t(count));
  const int oldest = frames.front().number;
  for (FeatureTrack& track : tracks) {
    const auto is_older = [&](const FeatureTrack::Sighting& sighting) {
      return sighting.frame < oldest;
    };
    track.sightings.erase(
        std::remove_if(track.sightings.begin(), track.sightings.end(), is_older),
        track.sightings.end());
  }
  const auto is_over = [](const FeatureTrack& track) {
    return !track.is_alive && track.sightings.empty();
  };
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), is_over), tracks.end());
}

} // namespace pcl_semantic::odometry
