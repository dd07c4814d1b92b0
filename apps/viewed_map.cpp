// SPDX-License-Identifier: BSD-3-Clause
#include "viewed_map.h"
#include "core/fail.h"

#include <pcl_semantic/dataset/kitti_sequence.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_semantic::tool {

namespace {

constexpr int kImageColumns = 480;
constexpr double kImagesApart = 1.5; // minimum [m]

// Classes in the legend's order, unlabelled last.
std::vector<ViewedClass>
classesOf(const std::vector<Label>& labels, const std::vector<LegendEntry>& legend)
{
  std::array<bool, 256> is_there{};
  for (const Label label : labels)
    is_there[label] = true;
  std::vector<ViewedClass> classes;
  for (int i = 1; i <= 256; ++i)
    if (is_there[std::size_t(i % 256)])
      classes.push_back({Label(i % 256), legend.at(classes.size())});
  return classes;
}

// Reduces an image to a maximum width, including its camera.
ViewedImage
smallImage(const cv::Mat& image, const StereoCamera& camera,
           const Eigen::Isometry3d& T_map_camera, int columns)
{
  ViewedImage picture{image, camera, T_map_camera};
  if (image.channels() == 1)
    cv::cvtColor(image, picture.image, cv::COLOR_GRAY2BGR);
  picture.camera.width = image.cols;
  picture.camera.height = image.rows;
  if (image.cols <= columns)
    return picture;
  const int rows = std::max(2, cvRound(double(image.rows) * columns / image.cols));
  cv::Mat small;
  cv::resize(picture.image, small, {columns, rows}, 0, 0, cv::INTER_AREA);
  picture.image = small;
  const double x = double(columns) / image.cols, y = double(rows) / image.rows;
  StereoCamera& changed = picture.camera;
  changed.fx *= x;
  changed.fy *= y;
  changed.cx = (changed.cx + 0.5) * x - 0.5;
  changed.cy = (changed.cy + 0.5) * y - 0.5;
  changed.width = columns;
  changed.height = rows;
  return picture;
}

// Moves the ceiling by some layers of voxels, initially from the top of the map.
Redraw
moveCeiling(const ViewedMap& map, int layers, double& ceiling)
{
  if (map.indices.empty())
    return Redraw::nothing;
  const auto begin = map.indices.begin();
  const auto [low, high] = std::minmax_element(
      begin, map.indices.end(),
      [](const VoxelIndex& a, const VoxelIndex& b) { return a.z() < b.z(); });
  const double half = 0.5 * map.grid.size;
  ceiling = std::clamp(ceiling, map.heightOf(std::size_t(low - begin)) - half,
                       map.heightOf(std::size_t(high - begin)) + half) +
            layers * map.grid.size;
  return Redraw::voxels;
}

Redraw
toggleAll(const ViewedMap& map, ViewState& state)
{
  const bool are_all_shown = state.hidden.empty();
  state.hidden.clear();
  if (are_all_shown)
    for (const ViewedClass& each : map.classes)
      state.hidden.insert(each.label);
  return Redraw::voxels;
}

// Selects the next object whose box is visible, and none after the last.
Redraw
selectNext(const ViewedMap& map, ViewState& state)
{
  std::size_t next = state.selected ? *state.selected + 1 : 0;
  while (next < map.objects.size() && !state.shows(map.objects[next]))
    ++next;
  state.selected.reset();
  if (next < map.objects.size())
    state.selected = next;
  return Redraw::panel;
}

Redraw
flip(bool& flag)
{
  flag = !flag;
  return Redraw::panel;
}

} // namespace

ViewedMap
viewedMap(const VoxelScene& scene, const LabelSet& label_set, const std::string& title)
{
  if (!scene.has_labels && !scene.has_colour)
    badInput(title, ": has neither labels nor colours, expected a field label, "
                    "probability, rgb or rgba");
  ViewedMap map;
  map.title = title;
  map.grid = scene.grid;
  map.indices = scene.voxels.indices;
  for (const pcl::PointXYZRGBL& point : *scene.voxels.cloud)
    map.labels.push_back(Label(point.label));
  if (scene.has_labels) {
    VoxelColours colours = classColours(scene, label_set);
    map.classes = classesOf(map.labels, colours.legend);
    colours.legend.clear();
    map.colourings.push_back({"class", std::move(colours)});
  }
  if (scene.has_colour)
    map.colourings.push_back({"rgb", measuredColours(scene)});
  if (scene.voxels.refined.size() == Eigen::Index(map.indices.size()))
    map.colourings.push_back({"entropy", entropyColours(scene)});
  return map;
}

std::vector<ViewedObject>
viewedObjects(const std::vector<ObjectSummary>& objects, const LabelSet& label_set,
              double voxel_size, const Eigen::Vector3d& origin)
{
  std::vector<ViewedObject> viewed;
  for (const ObjectSummary& object : objects) {
    ViewedObject each;
    each.text = cv::format("object %u: ", object.id) + label_set[object.label].name;
    if (object.track)
      each.text += object.track->moving ? ", moving" : ", still";
    if (object.track && object.track->speed > 0.0) // false for NaN
      each.text += cv::format(", %.1f m/s", object.track->speed);
    each.label = object.label;
    each.colour = classColour(label_set, object.label);
    each.box = object.yaw_box;
    each.box.centre -= origin;
    // The box of the points, which would be inside the outer voxels.
    each.box.size.array() += 1.5 * voxel_size;
    viewed.push_back(each);
  }
  return viewed;
}

std::size_t
colouringOf(const ViewedMap& map, const std::string& name)
{
  std::string known;
  for (std::size_t i = 0; i < map.colourings.size(); ++i) {
    if (map.colourings[i].name == name)
      return i;
    known += (i == 0 ? "" : ", ") + map.colourings[i].name;
  }
  badParameter(map.title, ": has no colours for --colour ", name, ", expected ", known);
}

std::vector<ViewedImage>
imagesOf(const std::string& sequence, const Trajectory& T_map_camera0, std::size_t most)
{
  const KittiSequence frames(sequence);
  std::vector<std::size_t> posed;
  Eigen::Vector3d last = Eigen::Vector3d::Constant(1e9);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto row = std::size_t(frames.frameNumber(i));
    if (row >= T_map_camera0.size() ||
        (T_map_camera0[row].translation() - last).norm() < kImagesApart)
      continue;
    last = T_map_camera0[row].translation();
    posed.push_back(i);
  }
  if (posed.empty())
    badInput(sequence, ": has no frame within the ", T_map_camera0.size(),
             " poses of the map");
  std::vector<ViewedImage> pictures;
  const std::size_t count = std::min(most, posed.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = posed[posed.size() - 1 - k * posed.size() / count];
    const Eigen::Isometry3d pose =
        T_map_camera0[std::size_t(frames.frameNumber(i))] * frames.T_camera0_camera();
    pictures.push_back(
        smallImage(frames.frame(i).left, frames.camera(), pose, kImageColumns));
  }
  return pictures;
}

Redraw
press(const std::string& key, const ViewedMap& map, int views, ViewState& state)
{
  for (const ViewedClass& each : map.classes)
    if (key == keyOf(each.label)) {
      toggle(each.label, state);
      return Redraw::voxels;
    }
  if (key == "a")
    return toggleAll(map, state);
  if (key == "m") {
    state.colouring = (state.colouring + 1) % map.colourings.size();
    return Redraw::voxels;
  }
  if (key == "Up" || key == "Down")
    return moveCeiling(map, key == "Up" ? 2 : -2, state.below);
  if (key == "Home") {
    state.below = std::numeric_limits<double>::infinity();
    return Redraw::voxels;
  }
  if (key == "v") {
    state.view = views == 0 ? 0 : (state.view + 1) % views;
    return Redraw::camera;
  }
  if (key == "q" || key == "Escape")
    return flip(state.is_closed);
  if (key == "n")
    return selectNext(map, state);
  return key == "t"   ? flip(state.path)
         : key == "b" ? flip(state.boxes)
         : key == "i" ? flip(state.pictures)
         : key == "l" ? flip(state.panel)
         : key == "h" ? flip(state.help)
                      : Redraw::nothing;
}

void
toggle(Label label, ViewState& state)
{
  if (state.hidden.erase(label) == 0)
    state.hidden.insert(label);
}

std::optional<std::size_t>
objectAt(const ViewedMap& map, const ViewState& state, const Eigen::Vector3d& from,
         const Eigen::Vector3d& to)
{
  std::optional<std::size_t> found;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.objects.size(); ++i) {
    const YawBox& box = map.objects[i].box;
    const Eigen::AngleAxisd back(-box.yaw, Eigen::Vector3d::UnitZ());
    const Eigen::Array3d begin = back * (from - box.centre), way = back * (to - from);
    const Eigen::Array3d lower = (-0.5 * box.size.array() - begin) / way,
                         upper = (0.5 * box.size.array() - begin) / way;
    const double enter = std::max(lower.min(upper).maxCoeff(), 0.0),
                 leave = lower.max(upper).minCoeff();
    if (state.shows(map.objects[i]) && enter <= leave && enter < nearest) {
      nearest = enter;
      found = i;
    }
  }
  return found;
}

std::string
keyOf(Label label)
{
  return label >= 1 && label <= 10 ? std::to_string(label % 10) : "";
}

const std::vector<std::string>&
helpOnKeys()
{
  static const std::vector<std::string> lines = {
      "1 ... 9, 0: class on, off",
      "click on a name: class on, off",
      "a: all classes on, off",
      "m: next colouring",
      "Down, Up: ceiling lower, higher",
      "Home: no ceiling",
      "t: path of the camera; b: boxes",
      "n, click on a box: its object",
      "i: pictures of the camera",
      "v: next view",
      "l: this panel; h: these lines",
      "mouse: turn; Shift: move; wheel: zoom",
      "q: close"};
  return lines;
}

} // namespace pcl_semantic::tool
