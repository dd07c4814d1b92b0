// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/clouds/point_cloud2.h>

#include "core/fail.h"
#include "table_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

template <typename T>
void
put(PcdTable& table, const std::string& name, const T* values, int count = 1)
{
  const auto elements = pcl::uindex_t(std::max(count, 1));
  table.setColumn({name, 0, pcl::traits::asEnum_v<T>, elements}, values,
                  table.points() * elements * sizeof(T));
}

// \param[in] count of its elements; 0 = any
PcdColumn
columnOf(const PcdTable& table, const std::string& name, int count = 1)
{
  const int index = table.find(name);
  const int found = index < 0 ? 0 : int(table.fields[std::size_t(index)].count);
  if (found == 0 || (count > 0 && found != count))
    badParameter("cloud: has no field '", name, "' of COUNT ", std::max(count, 1),
                 ", which a voxel cloud needs");
  return PcdColumn(table, index);
}

LabelDistributions
distributionsOf(const PcdTable& table, const std::string& name)
{
  const PcdColumn column = columnOf(table, name, 0);
  const int classes = int(column.field().count);
  LabelDistributions distributions(classes, Eigen::Index(table.points()));
  for (std::size_t i = 0; i < table.points(); ++i)
    for (int k = 0; k < classes; ++k) {
      const double value = column(i, k);
      if (!(value >= 0.0 && value <= 1.001))
        badInput("cloud: field '", name, "' of voxel ", i, " is ", value,
                 ", expected 0 to 1");
      distributions.matrix()(k, Eigen::Index(i)) = float(value);
    }
  return distributions;
}

double
wholeNumber(const PcdColumn& column, std::size_t i, double smallest, double largest,
            int element = 0)
{
  const double value = column(i, element);
  if (!(value >= smallest && value <= largest) || value != std::floor(value))
    badInput("cloud: field '", column.field().name, "' of voxel ", i, " is ", value,
             ", expected a whole number from ", smallest, " to ", largest);
  return value;
}

// Voxel indices of two maps, or of one before and after a motion, refer to two grids.
void
requireOneGrid(const PcdColumn& size, const PcdColumn& origin, std::size_t voxels)
{
  for (std::size_t i = 0; i < voxels; ++i) {
    if (!(size(i) > 0.0 && std::isfinite(size(i))))
      badInput("cloud: field 'voxel_size' of voxel ", i, " is ", size(i),
               ", expected more than 0");
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(origin(i, axis)))
        badInput("cloud: field 'origin' of voxel ", i, " is not finite");
    if (size(i) != size(0))
      badInput("cloud: voxel ", i, " has the size ", size(i), " m, voxel 0 ", size(0),
               " m, expected voxels of one map");
    for (int axis = 0; axis < 3; ++axis)
      if (origin(i, axis) != origin(0, axis))
        badInput("cloud: voxel ", i, " has the origin ", origin(i, 0), " ",
                 origin(i, 1), " ", origin(i, 2), ", voxel 0 ", origin(0, 0), " ",
                 origin(0, 1), " ", origin(0, 2), ", expected voxels of one map");
  }
}

} // namespace

void
toPCLPointCloud2(const VoxelCloud& voxels, pcl::PCLPointCloud2& cloud)
{
  const auto size = Eigen::Index(voxels.size());
  if (voxels.cloud->size() != voxels.size() || voxels.measured.size() != size ||
      voxels.refined.size() != size || voxels.observations.size() != voxels.size())
    badParameter("the arrays of a voxel cloud differ in length");
  Eigen::Matrix3Xi indices(3, size);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    indices.col(Eigen::Index(i)) = voxels.indices[i].matrix();
  const Eigen::Matrix3Xd origins = voxels.origin.replicate(1, size);
  const std::vector<double> sizes(voxels.size(), voxels.voxel_size);
  PcdTable table = tableOfPoints(*voxels.cloud, Eigen::Vector3d::Zero());
  put(table, "probability", voxels.refined.matrix().data(), voxels.refined.classes());
  put(table, "measured", voxels.measured.matrix().data(), voxels.measured.classes());
  put(table, "observations", voxels.observations.data());
  put(table, "index", indices.data(), 3);
  put(table, "voxel_size", sizes.data());
  put(table, "origin", origins.data(), 3);
  cloud = std::move(table);
}

void
fromPCLPointCloud2(const pcl::PCLPointCloud2& cloud, VoxelCloud& voxels)
{
  const PcdTable table(cloud);
  voxels = VoxelCloud();
  if (table.fields.empty() && table.points() == 0)
    return; // PCL's filters return such an empty cloud
  voxels.refined = distributionsOf(table, "probability");
  voxels.measured = distributionsOf(table, "measured");
  voxels.cloud->header = cloud.header;
  const PcdColumn x = columnOf(table, "x"), y = columnOf(table, "y"),
                  z = columnOf(table, "z"), colour = columnOf(table, "rgba"),
                  label = columnOf(table, "label"), index = columnOf(table, "index", 3),
                  observations = columnOf(table, "observations"),
                  size = columnOf(table, "voxel_size"),
                  origin = columnOf(table, "origin", 3);
  requireOneGrid(size, origin, table.points());
  const double classes = voxels.refined.classes();
  constexpr double any = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < table.points(); ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() << float(x(i)), float(y(i)), float(z(i));
    point.rgba = colour.bits(i);
    point.label = std::uint32_t(wholeNumber(label, i, 0, classes));
    voxels.cloud->push_back(point);
    VoxelIndex voxel;
    for (int axis = 0; axis < 3; ++axis)
      voxel[axis] = int(wholeNumber(index, i, -kMaxVoxelIndex, kMaxVoxelIndex, axis));
    voxels.indices.push_back(voxel);
    voxels.observations.push_back(std::uint32_t(wholeNumber(observations, i, 0, any)));
  }
  if (table.points() > 0) {
    voxels.voxel_size = size(0);
    voxels.origin << origin(0, 0), origin(0, 1), origin(0, 2);
  }
}

} // namespace pcl_semantic
