// SPDX-License-Identifier: BSD-3-Clause
#include "viewed_map.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/io/drawing.h>

#include <opencv2/imgproc.hpp>

#include <array>

namespace pcl_semantic::tool {

namespace {

constexpr int kImageColumns = 480;
constexpr double kImagesApart = 1.5; // at least [m]

// Flat colours of the label set: the faces are shaded so little that they can be seen.
VoxelColours
paintClasses(const ViewedMap& map, const LabelSet& label_set, std::string note)
{
  VoxelColours result;
  for (const Label label : map.labels)
    result.colours.push_back(classColour(label_set, label));
  result.note = std::move(note);
  return result;
}

std::vector<ViewedClass>
classesOf(const ViewedMap& map, const LabelSet& label_set)
{
  std::array<std::size_t, 256> counts{};
  for (const Label label : map.labels)
    ++counts[label];
  std::vector<ViewedClass> classes;
  for (int index = 1; index <= label_set.size() + 1; ++index) {
    const Label label(index <= label_set.size() ? index : 0); // unlabelled is the last
    if (counts[label] > 0)
      classes.push_back(
          {label, label_set[label].name, classColour(label_set, label), counts[label]});
  }
  return classes;
}

// A picture of no more than so many columns, its camera with it.
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

} // namespace

ViewedMap
viewedMap(const VoxelScene& scene, const LabelSet& label_set, const std::string& title)
{
  if (!scene.has_labels && !scene.has_colour)
    PCL_THROW_EXCEPTION(BadInputException,
                        title << ": has neither labels nor colours, expected a field "
                                 "label, probability, rgb or rgba");
  ViewedMap map;
  map.title = title;
  map.grid = scene.grid;
  map.indices = scene.voxels.indices;
  for (const pcl::PointXYZRGBL& point : *scene.voxels.cloud)
    map.labels.push_back(Label(point.label));
  if (scene.has_labels) { // says which labels are wrong, and how many voxels there are
    const std::string note = classColours(scene, label_set).note;
    map.colourings.push_back({"class", paintClasses(map, label_set, note)});
    map.classes = classesOf(map, label_set);
  }
  if (scene.has_colour)
    map.colourings.push_back({"rgb", measuredColours(scene)});
  if (scene.voxels.refined.size() == Eigen::Index(map.indices.size()))
    map.colourings.push_back({"entropy", entropyColours(scene)});
  if (scene.voxels.observations.size() == map.indices.size())
    map.colourings.push_back({"observations", observationColours(scene)});
  if (scene.cliques.size() == map.indices.size())
    map.colourings.push_back({"clique", cliqueColours(scene)});
  return map;
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
  PCL_THROW_EXCEPTION(InvalidParameterException, map.title << ": has nothing for "
                                                              "--colour "
                                                           << name << ", only for "
                                                           << known);
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
    PCL_THROW_EXCEPTION(BadInputException, sequence << ": has no frame within the "
                                                    << T_map_camera0.size()
                                                    << " poses of the map");
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

} // namespace pcl_semantic::tool
