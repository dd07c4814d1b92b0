// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/point_cloud2.h>

#include "core/fail.h"
#include "pcd_table.h"

#include <algorithm>

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
    for (int k = 0; k < classes; ++k)
      distributions.matrix()(k, Eigen::Index(i)) = float(column(i, k));
  return distributions;
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
  PcdTable table = tableOfPoints(*voxels.cloud);
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
    return; // as PCL's filters leave a cloud of which nothing is left
  voxels.refined = distributionsOf(table, "probability");
  voxels.measured = distributionsOf(table, "measured");
  voxels.cloud->header = cloud.header;
  const PcdColumn x = columnOf(table, "x"), y = columnOf(table, "y"),
                  z = columnOf(table, "z"), colour = columnOf(table, "rgba"),
                  label = columnOf(table, "label"), index = columnOf(table, "index", 3),
                  observations = columnOf(table, "observations"),
                  size = columnOf(table, "voxel_size"),
                  origin = columnOf(table, "origin", 3);
  for (std::size_t i = 0; i < table.points(); ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() << float(x(i)), float(y(i)), float(z(i));
    point.rgba = colour.bits(i);
    point.label = std::uint32_t(label(i));
    voxels.cloud->push_back(point);
    voxels.indices.emplace_back(int(index(i, 0)), int(index(i, 1)), int(index(i, 2)));
    voxels.observations.push_back(std::uint32_t(observations(i)));
  }
  if (table.points() > 0) {
    voxels.voxel_size = size(0);
    voxels.origin << origin(0, 0), origin(0, 1), origin(0, 2);
  }
}

} // namespace pcl_semantic
