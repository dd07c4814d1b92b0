// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/io/occupancy_grid.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <yaml-cpp/yaml.h>

namespace pcl_semantic {

/** \brief The columns of a scene seen from above, as an image: x to the right, y up. */
class VoxelColumns {
public:
  /** \throws BadInputException if they are too many for an image */
  explicit VoxelColumns(const VoxelScene& scene);

  cv::Size
  size() const
  {
    return {upper_.x() - lower_.x() + 1, upper_.y() - lower_.y() + 1};
  }

  /** \brief The pixel of a voxel's column; it may lie outside. */
  cv::Point
  pixelOf(const VoxelIndex& voxel) const
  {
    return {voxel.x() - lower_.x(), upper_.y() - voxel.y()};
  }

  bool
  contains(const VoxelIndex& voxel) const
  {
    return voxel.x() >= lower_.x() && voxel.x() <= upper_.x() &&
           voxel.y() >= lower_.y() && voxel.y() <= upper_.y();
  }

  /** \brief Index of the lowest voxel and column in each axis. */
  const VoxelIndex&
  lower() const
  {
    return lower_;
  }

private:
  VoxelIndex lower_, upper_;
};

/** \brief What a map stands on. */
struct LocalGround {
  cv::Mat height; ///< CV_32F: voxels below its upper side, from the lowest; NaN = none
  cv::Mat label;  ///< CV_8UC1: class of the column's own ground, 0 = none is seen
};

/** \brief Finds the ground of each column, see occupancyGrid().
 * \throws BadInputException if there is none at all */
LocalGround findGround(const VoxelScene& scene, const VoxelColumns& columns,
                       const OccupancyGridParameters& parameters);

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

// The voxels of the ground's classes, from below.
std::vector<std::size_t>
groundVoxels(const VoxelScene& scene, const std::vector<Label>& classes)
{
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    if (std::count(classes.begin(), classes.end(), (*scene.voxels.cloud)[i].label) > 0)
      rows.push_back(i);
  std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return VoxelIndexLess()(scene.voxels.indices[a], scene.voxels.indices[b]);
  });
  return rows;
}

// Top of the lowest stretch of ground in each column, where there is one.
LocalGround
ownGround(const VoxelScene& scene, const VoxelColumns& columns,
          const std::vector<std::size_t>& rows)
{
  LocalGround ground{cv::Mat(columns.size(), CV_32F, cv::Scalar(kNone)),
                     cv::Mat::zeros(columns.size(), CV_8UC1)};
  for (const std::size_t row : rows) {
    const VoxelIndex& voxel = scene.voxels.indices[row];
    float& height = ground.height.at<float>(columns.pixelOf(voxel));
    const auto below = static_cast<float>(voxel.z() - columns.lower().z());
    if (!std::isnan(height) && height != below)
      continue;
    height = below + 1.0f;
    ground.label.at<std::uint8_t>(columns.pixelOf(voxel)) =
        static_cast<std::uint8_t>((*scene.voxels.cloud)[row].label);
  }
  return ground;
}

// Gives every column the height of the nearest one that has one, and smooths them.
cv::Mat
spread(const cv::Mat& height, const cv::Mat& label, float reach)
{
  cv::Mat distance, nearest;
  cv::distanceTransform(label == 0, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<float> height_of(std::size_t(label.total()) + 1, kNone);
  for (int v = 0; v < label.rows; ++v)
    for (int u = 0; u < label.cols; ++u)
      if (label.at<std::uint8_t>(v, u) != 0)
        height_of[std::size_t(nearest.at<int>(v, u))] = height.at<float>(v, u);
  cv::Mat filled(height.size(), CV_32F), smooth;
  for (int v = 0; v < label.rows; ++v)
    for (int u = 0; u < label.cols; ++u)
      filled.at<float>(v, u) = height_of[std::size_t(nearest.at<int>(v, u))];
  cv::medianBlur(filled, smooth, 5);
  smooth.setTo(cv::Scalar(kNone), distance > reach);
  return smooth;
}

} // namespace

VoxelColumns::VoxelColumns(const VoxelScene& scene)
    : lower_(VoxelIndex::Constant(std::numeric_limits<int>::max())),
      upper_(VoxelIndex::Constant(std::numeric_limits<int>::min()))
{
  constexpr double most = 1 << 28;
  for (const VoxelIndex& voxel : scene.voxels.indices) {
    lower_ = lower_.cwiseMin(voxel);
    upper_ = upper_.cwiseMax(voxel);
  }
  if (scene.voxels.size() == 0)
    PCL_THROW_EXCEPTION(BadInputException, "the map has no voxel");
  const Eigen::Array3d cells = (upper_ - lower_).cast<double>().array() + 1.0;
  if (cells.x() * cells.y() > most || cells.z() > most)
    PCL_THROW_EXCEPTION(BadInputException, "the map is "
                                               << cells.x() << " x " << cells.y()
                                               << " columns large, expected at most "
                                               << most << " in all");
}

LocalGround
findGround(const VoxelScene& scene, const VoxelColumns& columns,
           const OccupancyGridParameters& parameters)
{
  const std::vector<std::size_t> rows = groundVoxels(scene, parameters.ground);
  if (rows.empty())
    PCL_THROW_EXCEPTION(BadInputException,
                        "the map has no voxel of the classes of the ground");
  LocalGround ground = ownGround(scene, columns, rows);
  const cv::Mat own = ground.height;
  ground.height =
      spread(own, ground.label, static_cast<float>(parameters.reach / scene.grid.size));
  // Ground above or below that around it is none: a roof, or noise under the road.
  const auto most = static_cast<float>(parameters.min_height / scene.grid.size);
  ground.label.setTo(0, cv::abs(own - ground.height) > most);
  return ground;
}

namespace {

void
requireHeights(const OccupancyGridParameters& parameters)
{
  if (!(parameters.min_height >= 0.0 && parameters.max_height > parameters.min_height &&
        std::isfinite(parameters.max_height)))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the heights are " << parameters.min_height << " and "
                                           << parameters.max_height
                                           << " m, expected 0 <= lower < upper");
  if (!(parameters.reach >= 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the reach of the ground is " << parameters.reach << " m");
}

// Of each column, whether one of the voxels lies between the heights above the ground.
cv::Mat
betweenHeights(const std::vector<VoxelIndex>& voxels, const VoxelScene& scene,
               const VoxelColumns& columns, const LocalGround& ground,
               const OccupancyGridParameters& parameters)
{
  cv::Mat found = cv::Mat::zeros(columns.size(), CV_8UC1);
  for (const VoxelIndex& voxel : voxels) {
    if (!columns.contains(voxel))
      continue;
    const cv::Point pixel = columns.pixelOf(voxel);
    const double centre = double(voxel.z()) - columns.lower().z() + 0.5;
    const double above = (centre - ground.height.at<float>(pixel)) * scene.grid.size;
    if (above >= parameters.min_height && above < parameters.max_height)
      found.at<std::uint8_t>(pixel) = 255; // never where there is no ground: NaN
  }
  return found;
}

OccupancyGrid
emptyGrid(const VoxelScene& scene, const VoxelColumns& columns)
{
  OccupancyGrid grid;
  grid.cells = cv::Mat(columns.size(), CV_8UC1, cv::Scalar(OccupancyGrid::kUnknown));
  grid.resolution = scene.grid.size;
  grid.origin = (scene.grid.corner + scene.origin +
                 columns.lower().cast<double>() * scene.grid.size)
                    .head<2>();
  return grid;
}

} // namespace

OccupancyGrid
occupancyGrid(const VoxelScene& scene, const OccupancyGridParameters& parameters)
{
  requireHeights(parameters);
  const VoxelColumns columns(scene);
  const LocalGround ground = findGround(scene, columns, parameters);
  OccupancyGrid grid = emptyGrid(scene, columns);
  const cv::Mat is_free =
      scene.knows_free ? betweenHeights(scene.free, scene, columns, ground, parameters)
                       : cv::Mat(ground.label != 0);
  grid.cells.setTo(OccupancyGrid::kFree, is_free);
  grid.cells.setTo(
      OccupancyGrid::kOccupied,
      betweenHeights(scene.voxels.indices, scene, columns, ground, parameters));
  return grid;
}

OccupancyGrid
traversabilityGrid(const VoxelScene& scene, const OccupancyGridParameters& parameters)
{
  requireHeights(parameters);
  const VoxelColumns columns(scene);
  const LocalGround ground = findGround(scene, columns, parameters);
  OccupancyGrid grid = emptyGrid(scene, columns);
  grid.cells.setTo(OccupancyGrid::kOccupied, ground.label != 0);
  for (const Label label : parameters.traversable)
    if (label != kUnlabelled)
      grid.cells.setTo(OccupancyGrid::kFree, ground.label == label);
  grid.cells.setTo(
      OccupancyGrid::kOccupied,
      betweenHeights(scene.voxels.indices, scene, columns, ground, parameters));
  return grid;
}

std::string
gridDescription(const std::string& path)
{
  return std::filesystem::path(path).replace_extension(".yaml").string();
}

void
writeOccupancyGrid(const std::string& path, const OccupancyGrid& grid)
{
  YAML::Emitter yaml;
  yaml.SetDoublePrecision(15);
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "image" << YAML::Value
       << std::filesystem::path(path).filename().string();
  yaml << YAML::Key << "resolution" << YAML::Value << grid.resolution;
  yaml << YAML::Key << "origin" << YAML::Value << YAML::Flow
       << std::vector<double>{grid.origin.x(), grid.origin.y(), 0.0};
  yaml << YAML::Key << "negate" << YAML::Value << 0;
  // As map_saver writes them: 205 is then unknown.
  yaml << YAML::Key << "occupied_thresh" << YAML::Value << 0.65;
  yaml << YAML::Key << "free_thresh" << YAML::Value << 0.196;
  yaml << YAML::EndMap;

  AtomicFile image(path), description(gridDescription(path));
  image.stream() << "P5\n" << grid.cells.cols << " " << grid.cells.rows << "\n255\n";
  for (int row = 0; row < grid.cells.rows; ++row)
    image.stream().write(grid.cells.ptr<char>(row), grid.cells.cols);
  description.stream() << yaml.c_str() << "\n";
  image.commit();
  description.commit();
}

} // namespace pcl_semantic
