// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/voxel_scene.h>

#include "core/fail.h"
#include "core/label_number.h"
#include "map/block_reader.h"

#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/map/voxel_set.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace pcl_semantic {

namespace {

// Positions of the finite points relative to an origin, in double precision, which the
// file may have.
struct FinitePoints {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::size_t> rows; // of the file
};

FinitePoints
finitePoints(const PcdTable& table, const Eigen::Vector3d& origin)
{
  if (table.points() == 0) // may have no fields
    return {};
  const PcdColumn x(table, table.find("x")), y(table, table.find("y")),
      z(table, table.find("z"));
  const bool zero_is_none = countNoReturns(table.points(), [&](std::size_t i) {
                              return x(i) == 0.0 && y(i) == 0.0 && z(i) == 0.0;
                            }) > 0;
  FinitePoints points;
  points.positions.reserve(table.points());
  points.rows.reserve(table.points());
  for (std::size_t i = 0; i < table.points(); ++i) {
    const Eigen::Vector3d position(x(i), y(i), z(i));
    if (!position.allFinite() || (zero_is_none && position.isZero(0.0)))
      continue; // no measurement
    points.positions.emplace_back(position - origin);
    points.rows.push_back(i);
  }
  return points;
}

// The smallest step between coordinates of the first points; 0 if there is none.
double
smallestStep(const std::vector<Eigen::Vector3d>& positions)
{
  constexpr std::size_t enough = 50000;
  double step = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (std::size_t i = 0; i < std::min(enough, positions.size()); ++i)
      values.push_back(positions[i][axis]);
    std::sort(values.begin(), values.end());
    for (std::size_t i = 1; i < values.size(); ++i) {
      const double each = values[i] - values[i - 1];
      // Coordinates of one row of voxels may differ in the last bit.
      if (each > std::max(1e-5, 2e-7 * std::abs(values[i])) &&
          (step == 0.0 || each < step))
        step = each;
    }
  }
  return step;
}

// Refines the step by increasingly long distances, because single precision rounds
// short ones.
double
refinedStep(const std::vector<Eigen::Vector3d>& positions, double step)
{
  double longest = step;
  for (const Eigen::Vector3d& position : positions)
    for (int axis = 0; axis < 3; ++axis) {
      const double distance = std::abs(position[axis] - positions.front()[axis]);
      if (distance <= 2.0 * longest)
        continue;
      step = distance / std::round(distance / step);
      longest = distance;
    }
  // Voxel sizes are round numbers of metres.
  const double rounded = std::round(step * 1e4) / 1e4;
  return std::abs(rounded - step) < 1e-3 * step * step / longest ? rounded : step;
}

VoxelGrid
findGrid(const std::string& path, const std::vector<Eigen::Vector3d>& positions,
         const Eigen::Vector3d& origin)
{
  VoxelGrid grid;
  if (positions.empty())
    return grid;
  const double step = smallestStep(positions);
  if (step > 0.0)
    grid.size = refinedStep(positions, step);
  grid.corner = positions.front().array() - 0.5 * grid.size;
  for (const Eigen::Vector3d& position : positions) {
    const Eigen::Array3d cells = (position - grid.corner).array() / grid.size - 0.5;
    if (!((cells - cells.round()).abs() < 0.1).all())
      badInput(path,
               ": points are not voxel centres; give the voxel size with --voxel-size");
  }
  // Aligned as maps of this library, within single precision.
  const Eigen::Array3d first = (grid.corner + origin).array() / grid.size;
  if (((first - first.round()).abs() < 0.01).all())
    grid.corner = -origin;
  return grid;
}

std::vector<VoxelIndex>
indicesOf(const std::string& path, const std::vector<Eigen::Vector3d>& positions,
          const VoxelGrid& grid)
{
  std::vector<VoxelIndex> indices;
  indices.reserve(positions.size());
  for (const Eigen::Vector3d& position : positions) {
    const Eigen::Array3d cell = ((position - grid.corner).array() / grid.size).floor();
    if (!(cell.abs() < double(kMaxVoxelIndex)).all())
      badInput(path, ": a point lies ", position.norm(),
               " m away, too far for voxels of ", grid.size, " m");
    indices.emplace_back(cell.cast<int>());
  }
  return indices;
}

// The representative point of a voxel, and the mean colour.
std::size_t
standIn(const LabelledCloud& labelled, const std::vector<std::size_t>& rows,
        const std::size_t* begin, const std::size_t* end, pcl::PointXYZRGBL& point)
{
  point = (*labelled.cloud)[rows[*begin]];
  if (end - begin == 1)
    return *begin;
  std::array<std::size_t, 256> votes{};
  std::array<std::size_t, 3> colour{};
  for (const std::size_t* i = begin; i != end; ++i) {
    const pcl::PointXYZRGBL& each = (*labelled.cloud)[rows[*i]];
    ++votes[each.label];
    colour[0] += each.r;
    colour[1] += each.g;
    colour[2] += each.b;
  }
  const auto label = static_cast<std::uint32_t>(
      std::max_element(votes.begin(), votes.end()) - votes.begin());
  const std::size_t* const first = std::find_if(begin, end, [&](std::size_t i) {
    return (*labelled.cloud)[rows[i]].label == label;
  });
  const auto count = static_cast<std::size_t>(end - begin);
  point = (*labelled.cloud)[rows[*first]];
  point.r = static_cast<std::uint8_t>(colour[0] / count);
  point.g = static_cast<std::uint8_t>(colour[1] / count);
  point.b = static_cast<std::uint8_t>(colour[2] / count);
  return *first;
}

// The distributions of the selected rows.
LabelDistributions
distributionsOf(const LabelDistributions& all, const std::vector<std::size_t>& rows)
{
  LabelDistributions::Matrix values(all.classes(), Eigen::Index(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    values.col(Eigen::Index(i)) = all.matrix().col(Eigen::Index(rows[i]));
  return LabelDistributions(std::move(values));
}

} // namespace

VoxelScene
readVoxelScene(const std::string& path, const VoxelGrid& grid,
               const VoxelGrid& otherwise)
{
  const LabelledCloud labelled = readLabelledCloud(path);
  // Points, and thus the grid, are relative to the subtracted origin.
  const FinitePoints points = finitePoints(labelled.table, labelled.origin);
  VoxelScene scene;
  scene.origin = labelled.origin;
  scene.doubts = labelled.table.doubts;
  scene.has_colour = labelled.has_colour;
  scene.has_labels = labelled.has_labels;
  const auto& [size, x, y, z] = labelled.table.voxel_grid;
  if (grid.size > 0.0)
    scene.grid = {grid.size, grid.corner - scene.origin};
  else if (size > 0.0) {
    // Voxel 0 of a map begins at the world's origin, which locates the file's points.
    scene.grid = {size, Eigen::Vector3d(x, y, z) - labelled.origin};
    scene.origin = labelled.origin - Eigen::Vector3d(x, y, z);
  }
  else if (otherwise.size > 0.0)
    scene.grid = {otherwise.size, otherwise.corner - scene.origin};
  else
    scene.grid = findGrid(path, points.positions, scene.origin);
  scene.voxels.voxel_size = scene.grid.size;
  scene.voxels.origin = scene.grid.corner;
  const std::vector<VoxelIndex> indices = indicesOf(path, points.positions, scene.grid);
  std::vector<std::size_t> order(indices.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  // A map has each voxel once, so its order stays.
  if (VoxelSet(indices).size() < indices.size())
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return VoxelIndexLess()(indices[a], indices[b]);
    });
  std::vector<std::size_t> kept;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && indices[order[end]] == indices[order[begin]])
      ++end;
    pcl::PointXYZRGBL point;
    kept.push_back(points.rows[standIn(labelled, points.rows, order.data() + begin,
                                       order.data() + end, point)]);
    scene.voxels.cloud->push_back(point);
    scene.voxels.indices.push_back(indices[order[begin]]);
  }
  if (labelled.distributions.classes() > 0)
    scene.voxels.refined = distributionsOf(labelled.distributions, kept);
  return scene;
}

VoxelScene
sceneOf(const SemanticVoxelMap& map, bool with_free)
{
  VoxelScene scene;
  scene.has_colour = scene.has_labels = true;
  scene.voxels = map.occupiedEverywhere();
  scene.origin = map.cloudOrigin();
  // Voxel 0 begins at the world's origin; the points are relative to the map's origin.
  scene.grid = {scene.voxels.voxel_size, -scene.origin};
  if (std::string doubt = doubtOfSteps(*scene.voxels.cloud, "the map"); !doubt.empty())
    scene.doubts.push_back(std::move(doubt));
  scene.voxels.origin = scene.grid.corner;
  if (!with_free)
    return scene;
  scene.knows_free = true;
  const BlockReader reader(map.labelSet().size(), map.parameters());
  map.forEachBlock([&](const VoxelIndex& index, const VoxelBlock& block) {
    for (int offset = 0; offset < kBlockVoxels; ++offset)
      if (reader.occupancy(block, offset) == Occupancy::free)
        scene.free.push_back(voxelAt(index, offset));
  });
  return scene;
}

std::vector<Label>
labelsAtVoxels(const VoxelScene& scene, const VoxelScene& other)
{
  const Eigen::Array3d shift =
      (other.grid.corner + other.origin - scene.grid.corner - scene.origin).array() /
      scene.grid.size;
  if (std::abs(other.grid.size - scene.grid.size) > 1e-6 * scene.grid.size ||
      !((shift - shift.round()).abs() < 0.01).all())
    badParameter("the maps have different voxels, of ", scene.grid.size, " m and ",
                 other.grid.size, " m");
  std::unordered_map<VoxelIndex, Label, VoxelIndexHash> labels;
  labels.reserve(other.voxels.size());
  const VoxelIndex step = shift.round().cast<int>();
  for (std::size_t i = 0; i < other.voxels.size(); ++i)
    labels.emplace(other.voxels.indices[i] + step,
                   requireLabel((*other.voxels.cloud)[i].label));
  std::vector<Label> result(scene.voxels.size(), kUnlabelled);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const auto found = labels.find(scene.voxels.indices[i]);
    if (found != labels.end())
      result[i] = found->second;
  }
  return result;
}

} // namespace pcl_semantic
