// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/object_tracker.h>

#include "core/fail.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace pcl_semantic {

namespace {

using Number = std::uint32_t;

template <typename T>
using VoxelMapOf = std::unordered_map<VoxelIndex, T, VoxelIndexHash>;

// Frames over which motion is measured, and after which a lost object has no predicted
// place.
constexpr int kMemory = 5;
// Share of the voxels seen of an object that have to be free again if it moves.
constexpr double kMovedShare = 0.5;
// Gap between a place and the next one of an object with unknown motion [m/frame].
constexpr double kMaxJump = 3.0;

// Its voxels are in any order, and cells have their observations.
struct Track : MapObject {
  ObjectTracker::Window extent; // contains all voxels
  bool is_changed = true;       // since the last takeChanges()
};

// A group of voxels of one class in the present map.
struct Component {
  Label label = kUnlabelled;
  pcl::Indices indices;
  ObjectSighting seen;                  // by the present frame
  std::map<Number, std::size_t> shared; // voxels that are a track's, or will be
  Track* track = nullptr;
};

struct Cell {
  Number object = 0;
  std::uint32_t observations = 0;
};

// World frame [m].
Eigen::Vector3d
positionOf(const VoxelCloud& voxels, std::size_t i)
{
  return (*voxels.cloud)[i].getVector3fMap().cast<double>() + voxels.origin;
}

// Whether update() can change the voxels of a track.
bool
isIn(const ObjectTracker::Window& window, const Track& track)
{
  return window.intersects(track.extent);
}

} // namespace

void
ObjectTracker::Parameters::validate() const
{
  if (!(gap > 0.0 && std::isfinite(gap)))
    badParameter("object_gap is ", gap, ", expected a positive number");
  if (min_voxels < 1)
    badParameter("object_min_voxels is ", min_voxels, ", expected 1 or more");
}

struct ObjectTracker::State {
  LabelSet label_set;
  ObjectExtraction<pcl::PointXYZRGBL> extraction;
  std::map<Number, Track> tracks;
  VoxelMapOf<Cell> cells; // voxels of objects
  std::size_t min_voxels = 0;
  Number last_number = 0;
  int frames = 0;
  FrameTime frame;             // of the last update
  bool has_new_labels = false; // in updateLabels()
  std::vector<VoxelIndex> left;

  std::vector<Component> components(const VoxelCloud& voxels);
  VoxelMapOf<Number> predictions(double voxel_size) const;
  Eigen::Vector3d predictedMotion(const Track& track) const;
  std::vector<Component> split(Component component, const VoxelCloud& voxels,
                               const VoxelMapOf<Number>& predicted) const;
  void matchShared(std::vector<Component>& components);
  void matchNear(std::vector<Component>& components);
  void judgeMotion(Track& track, const Component& component, double voxel_size,
                   const Window& window);
  void take(Component& component, const VoxelCloud& voxels, const Window& window,
            const VoxelMapOf<Number>& predicted);
  void update(const VoxelCloud& voxels, const Window& window, bool again);
  bool hasSeen(const Track& track) const;
  MapObject objectOf(const Track& track) const;
  MapObjects common() const;
};

ObjectTracker::ObjectTracker(const LabelSet& label_set, const Parameters& parameters)
    : state_(std::make_unique<State>())
{
  parameters.validate();
  state_->label_set = label_set;
  state_->extraction.setLabelSet(label_set);
  state_->extraction.setGap(parameters.gap);
  state_->min_voxels = std::size_t(parameters.min_voxels);
  state_->extraction.setMinClusterSize(state_->min_voxels);
}

ObjectTracker::~ObjectTracker() = default;

const std::vector<VoxelIndex>&
ObjectTracker::leftVoxels() const
{
  return state_->left;
}

namespace {

// Finds the voxels of a component that the frame hit: those with more observations
// than before.
void
see(Component& component, const VoxelCloud& voxels, const VoxelMapOf<Cell>& cells)
{
  component.seen = ObjectSighting();
  for (const pcl::index_t index : component.indices) {
    const auto i = std::size_t(index);
    const auto cell = cells.find(voxels.indices[i]);
    if (cell != cells.end() && cell->second.observations == voxels.observations[i])
      continue;
    const Eigen::Vector3d point = positionOf(voxels, i);
    component.seen.centre += point;
    component.seen.box.extend(point);
    component.seen.voxels.push_back(voxels.indices[i]);
  }
  if (!component.seen.voxels.empty())
    component.seen.centre /= double(component.seen.voxels.size());
}

// Moves a part of an object, which the frame did not see, to the rest of it.
void
join(Component& rest, Component& part)
{
  rest.indices.insert(rest.indices.end(), part.indices.begin(), part.indices.end());
  part = Component();
}

} // namespace

// The objects of the present map, without tracks.
std::vector<Component>
ObjectTracker::State::components(const VoxelCloud& voxels)
{
  std::vector<pcl::PointIndices> objects;
  extraction.setInputCloud(voxels.cloud);
  extraction.extract(objects);
  std::vector<Component> found;
  for (pcl::PointIndices& object : objects) {
    Component component;
    component.label = Label((*voxels.cloud)[std::size_t(object.indices.front())].label);
    component.indices = std::move(object.indices);
    found.push_back(std::move(component));
  }
  return found;
}

// Motion of a track from its last sighting to the present frame [m].
Eigen::Vector3d
ObjectTracker::State::predictedMotion(const Track& track) const
{
  if (!track.summary.moving)
    return Eigen::Vector3d::Zero();
  return track.summary.motion * double(frames - track.last_frame);
}

// The voxels in which moving objects should be now.
VoxelMapOf<Number>
ObjectTracker::State::predictions(double voxel_size) const
{
  VoxelMapOf<Number> predicted;
  for (const auto& [number, track] : tracks) {
    if (!track.summary.moving || frames - track.last_frame > kMemory)
      continue;
    const VoxelIndex shift =
        (predictedMotion(track) / voxel_size).array().round().cast<int>();
    for (const VoxelIndex& voxel : track.voxels)
      predicted.emplace(voxel + shift, number);
  }
  return predicted;
}

// Divides a component that a moving object shares with another one.
std::vector<Component>
ObjectTracker::State::split(Component component, const VoxelCloud& voxels,
                            const VoxelMapOf<Number>& predicted) const
{
  const bool has_moving = std::any_of(
      component.shared.begin(), component.shared.end(),
      [&](const auto& each) { return tracks.at(each.first).summary.moving; });
  std::vector<Component> parts;
  if (component.shared.size() < 2 || !has_moving) {
    parts.push_back(std::move(component));
    return parts;
  }
  std::map<Number, Component> part;
  std::map<Number, Eigen::AlignedBox3d> place;
  for (const auto& [number, count] : component.shared) {
    const Track& track = tracks.at(number);
    if (!track.sightings.empty())
      place[number] = track.sightings.back().box;
    place[number].translate(predictedMotion(track));
  }
  for (const pcl::index_t index : component.indices) {
    const VoxelIndex& voxel = voxels.indices[std::size_t(index)];
    Number owner = 0;
    if (const auto coming = predicted.find(voxel); coming != predicted.end())
      owner = coming->second;
    else if (const auto cell = cells.find(voxel); cell != cells.end())
      owner = cell->second.object;
    if (component.shared.count(owner) == 0) {
      const Eigen::Vector3d point = positionOf(voxels, std::size_t(index));
      double nearest = HUGE_VAL;
      for (const auto& [number, box] : place)
        if (const double distance = box.squaredExteriorDistance(point);
            distance < nearest) {
          nearest = distance;
          owner = number;
        }
    }
    part[owner].indices.push_back(index);
  }
  for (auto& [number, each] : part) {
    each.label = component.label;
    each.shared[number] = each.indices.size();
    parts.push_back(std::move(each));
  }
  return parts;
}

// Gives each component the track with which it shares most voxels. A part of an object
// that fell apart without a new hit stays with the rest. A track that shares voxels
// with no other component joins the one of that component.
void
ObjectTracker::State::matchShared(std::vector<Component>& components)
{
  std::vector<std::tuple<std::ptrdiff_t, Number, std::size_t>> pairs;
  for (std::size_t c = 0; c < components.size(); ++c)
    for (const auto& [number, count] : components[c].shared)
      pairs.emplace_back(-std::ptrdiff_t(count), number, c); // most shared first
  std::sort(pairs.begin(), pairs.end());
  std::set<Number> taken;
  for (const auto& [count, number, c] : pairs)
    if (!components[c].track && taken.count(number) == 0) {
      components[c].track = &tracks.at(number);
      taken.insert(number);
    }
  for (const auto& [count, number, c] : pairs)
    if (!components[c].track && components[c].seen.voxels.empty())
      for (Component& rest : components)
        if (rest.track && rest.track->number == number) {
          join(rest, components[c]);
          break;
        }
  for (const auto& [count, number, c] : pairs)
    if (taken.count(number) == 0) {
      taken.insert(number);
      Track& joined = tracks.at(number);
      if (joined.summary.moving) // it may come into view again
        continue;
      Track& whole = *components[c].track;
      whole.voxels.insert(whole.voxels.end(), joined.voxels.begin(),
                          joined.voxels.end());
      whole.extent.extend(joined.extent);
      for (const VoxelIndex& voxel : joined.voxels)
        cells[voxel].object = whole.number;
      whole.summary.first_frame =
          std::min(whole.summary.first_frame, joined.summary.first_frame);
      whole.summary.frames = std::max(whole.summary.frames, joined.summary.frames);
      tracks.erase(number);
    }
}

// Gives each other component that the frame saw the nearest lost track of its class.
void
ObjectTracker::State::matchNear(std::vector<Component>& components)
{
  std::set<Number> taken;
  for (const Component& component : components)
    if (component.track)
      taken.insert(component.track->number);
  std::vector<std::tuple<double, Number, std::size_t>> pairs;
  for (const auto& [number, track] : tracks) {
    const int since = frames - track.last_frame;
    if (taken.count(number) > 0 || track.sightings.empty() || since > kMemory ||
        !label_set[track.label].dynamic)
      continue;
    Eigen::AlignedBox3d place = track.sightings.back().box;
    place.translate(predictedMotion(track));
    const double reach = kMaxJump * (track.summary.moving ? 0.5 : 1.0) * since;
    for (std::size_t c = 0; c < components.size(); ++c)
      if (!components[c].track && components[c].label == track.label &&
          !components[c].seen.voxels.empty())
        if (const double gap = place.exteriorDistance(components[c].seen.box);
            gap < reach)
          pairs.emplace_back(gap, number, c);
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [gap, number, c] : pairs)
    if (!components[c].track && taken.count(number) == 0) {
      components[c].track = &tracks.at(number);
      taken.insert(number);
    }
}

// Whether the present frame has seen a track before its labels changed.
bool
ObjectTracker::State::hasSeen(const Track& track) const
{
  return has_new_labels && !track.sightings.empty() &&
         track.sightings.back().frame == frames;
}

// Compares the present sighting of an object with an earlier one.
void
ObjectTracker::State::judgeMotion(Track& track, const Component& component,
                                  double voxel_size, const Window& window)
{
  if (!label_set[track.label].dynamic || component.seen.voxels.empty() ||
      track.sightings.empty() || has_new_labels)
    return;
  const ObjectSighting& before = track.sightings.front();
  std::size_t inside = 0, gone = 0;
  for (const VoxelIndex& voxel : before.voxels)
    if (window.contains(voxel)) {
      ++inside;
      gone += cells.count(voxel) == 0;
    }
  const Eigen::Vector3d motion =
      (component.seen.centre - before.centre) / double(frames - before.frame);
  const bool has_moved =
      inside > 0 && double(gone) > kMovedShare * double(inside) &&
      (component.seen.centre - before.centre).norm() > 3.0 * voxel_size;
  if (has_moved)
    track.last_moved = frames;
  track.summary.moving = track.last_moved && frames - *track.last_moved < 3;
  track.summary.motion = Eigen::Vector3d::Zero();
  track.summary.speed = 0.0;
  if (!track.summary.moving)
    return;
  track.summary.motion = motion;
  const double seconds = component.seen.timestamp - before.timestamp;
  track.summary.speed = seconds > 0.0
                            ? (component.seen.centre - before.centre).norm() / seconds
                            : std::numeric_limits<double>::quiet_NaN();
}

// Updates the track of a component, and the cells of its voxels.
void
ObjectTracker::State::take(Component& component, const VoxelCloud& voxels,
                           const Window& window, const VoxelMapOf<Number>& predicted)
{
  Track& track = *component.track;
  track.label = component.label;
  track.is_changed = true;
  component.seen.frame = frames;
  component.seen.timestamp = frame.timestamp;
  judgeMotion(track, component, voxels.voxel_size, window);
  std::vector<VoxelIndex> kept;
  for (const VoxelIndex& voxel : track.voxels)
    if (!window.contains(voxel))
      kept.push_back(voxel);
  for (const pcl::index_t index : component.indices) {
    const VoxelIndex& voxel = voxels.indices[std::size_t(index)];
    const std::uint32_t observations = voxels.observations[std::size_t(index)];
    if (track.summary.moving && !has_new_labels) {
      const auto cell = cells.find(voxel);
      const bool is_seen =
          cell == cells.end() || cell->second.observations != observations;
      const auto coming = predicted.find(voxel);
      if (!is_seen && (coming == predicted.end() || coming->second != track.number)) {
        left.push_back(voxel);
        cells.erase(voxel);
        continue;
      }
    }
    kept.push_back(voxel);
    cells[voxel] = {track.number, observations};
  }
  track.voxels = std::move(kept);
  track.extent.setEmpty();
  for (const VoxelIndex& voxel : track.voxels)
    track.extent.extend(voxel);
  if (component.seen.voxels.empty() || hasSeen(track))
    return;
  track.last_frame = frames;
  track.summary.last_frame = frame.number;
  ++track.summary.frames;
  track.sightings.push_back(std::move(component.seen));
  while (frames - track.sightings.front().frame > kMemory)
    track.sightings.pop_front();
}

void
ObjectTracker::update(const VoxelCloud& voxels, const Window& window,
                      const FrameTime& frame)
{
  state_->frame = frame;
  state_->update(voxels, window, false);
}

void
ObjectTracker::updateLabels(const VoxelCloud& voxels, const Window& window)
{
  state_->frames = std::max(0, state_->frames - 1); // the last frame
  state_->update(voxels, window, true);
}

void
ObjectTracker::State::update(const VoxelCloud& voxels, const Window& window, bool again)
{
  has_new_labels = again;
  left.clear();
  const VoxelMapOf<Number> predicted = predictions(voxels.voxel_size);
  std::vector<Component> found;
  std::unordered_set<VoxelIndex, VoxelIndexHash> present;
  for (Component& whole : components(voxels)) {
    for (const pcl::index_t index : whole.indices) {
      const VoxelIndex& voxel = voxels.indices[std::size_t(index)];
      present.insert(voxel);
      const auto cell = cells.find(voxel);
      if (cell != cells.end())
        ++whole.shared[cell->second.object];
      const auto coming = predicted.find(voxel);
      if (coming != predicted.end() &&
          (cell == cells.end() || cell->second.object != coming->second))
        ++whole.shared[coming->second];
    }
    for (Component& part : split(std::move(whole), voxels, predicted)) {
      see(part, voxels, cells);
      found.push_back(std::move(part));
    }
  }
  // Voxels of the window that are no object's any more.
  for (auto& [number, track] : tracks) {
    if (!isIn(window, track))
      continue;
    track.is_changed = true;
    const auto is_gone = [&](const VoxelIndex& voxel) {
      return window.contains(voxel) && present.count(voxel) == 0;
    };
    for (const VoxelIndex& voxel : track.voxels)
      if (is_gone(voxel))
        cells.erase(voxel);
    track.voxels.erase(
        std::remove_if(track.voxels.begin(), track.voxels.end(), is_gone),
        track.voxels.end());
  }
  matchShared(found);
  matchNear(found);
  for (Component& component : found) {
    if (component.indices.empty()) // it has joined another one
      continue;
    if (!component.track) {
      Track track;
      track.number = ++last_number;
      track.summary.first_frame = frame.number;
      component.track = &(tracks[track.number] = std::move(track));
    }
    take(component, voxels, window, predicted);
  }
  // Voxels that changed their object are in two lists: only one has the cell.
  for (auto track = tracks.begin(); track != tracks.end();) {
    auto& list = track->second.voxels;
    const Number number = track->first;
    const auto is_others = [&](const VoxelIndex& voxel) {
      const auto cell = cells.find(voxel);
      return cell == cells.end() || cell->second.object != number;
    };
    if (isIn(window, track->second))
      list.erase(std::remove_if(list.begin(), list.end(), is_others), list.end());
    const bool is_over = list.empty() && frames - track->second.last_frame > kMemory;
    track = is_over ? tracks.erase(track) : std::next(track);
  }
  ++frames;
}

std::vector<std::uint32_t>
ObjectTracker::numbers(const VoxelCloud& voxels) const
{
  std::vector<std::uint32_t> numbers(voxels.size(), 0);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const auto cell = state_->cells.find(voxels.indices[i]);
    if (cell == state_->cells.end())
      continue;
    const Track& track = state_->tracks.at(cell->second.object);
    if (track.label == (*voxels.cloud)[i].label &&
        track.voxels.size() >= state_->min_voxels)
      numbers[i] = track.number;
  }
  return numbers;
}

std::vector<ObjectSummary>
ObjectTracker::summarize(const VoxelCloud& voxels) const
{
  return summarizeObjects(voxels, [&](Number number) -> const MapObject& {
    return state_->tracks.at(number);
  });
}

MapObjects
ObjectTracker::objects() const
{
  MapObjects all = state_->common();
  for (const auto& [number, track] : state_->tracks)
    all.objects.push_back(state_->objectOf(track));
  return all;
}

MapObjects
ObjectTracker::takeChanges()
{
  MapObjects all = state_->common();
  for (auto& [number, track] : state_->tracks) {
    if (track.is_changed)
      all.objects.push_back(state_->objectOf(track));
    else
      all.unchanged.push_back(number);
    track.is_changed = false;
  }
  return all;
}

// Without objects.
MapObjects
ObjectTracker::State::common() const
{
  MapObjects all;
  all.last_number = last_number;
  all.frames = frames;
  all.min_voxels = min_voxels;
  return all;
}

MapObject
ObjectTracker::State::objectOf(const Track& track) const
{
  MapObject object = track;
  std::sort(object.voxels.begin(), object.voxels.end(), VoxelIndexLess());
  for (const VoxelIndex& voxel : object.voxels)
    object.observations.push_back(cells.at(voxel).observations);
  return object;
}

void
ObjectTracker::restore(MapObjects all)
{
  state_->last_number = all.last_number;
  state_->frames = all.frames;
  state_->left.clear();
  state_->tracks.clear();
  state_->cells.clear();
  for (MapObject& object : all.objects) {
    Track track;
    for (std::size_t i = 0; i < object.voxels.size(); ++i) {
      track.extent.extend(object.voxels[i]);
      state_->cells[object.voxels[i]] = {object.number, object.observations[i]};
    }
    static_cast<MapObject&>(track) = std::move(object);
    track.observations.clear();
    track.is_changed = false;
    state_->tracks[track.number] = std::move(track);
  }
}

} // namespace pcl_semantic
