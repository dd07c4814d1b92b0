// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/point_cloud2.h>

#include "core/fail.h"

#include <pcl/common/io.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

std::uint8_t
datatypeOf(const PcdField& field)
{
  const int datatype = pcl::getFieldType(field.size, field.type);
  if (datatype < 0)
    badParameter("field '", field.name, "' has the type ", field.type, field.size,
                 ", which PCL does not have");
  return std::uint8_t(datatype);
}

PcdField
fieldOf(const pcl::PCLPointField& field)
{
  const PcdField result{field.name, pcl::getFieldType(field.datatype),
                        pcl::getFieldSize(field.datatype),
                        int(std::max<pcl::uindex_t>(field.count, 1))};
  if (field.count > kMaxPcdCount || !result.isValid())
    badParameter("cloud: field '", field.name, "' has type ", int(field.datatype),
                 " and count ", field.count);
  return result;
}

void
requireBytes(const pcl::PCLPointCloud2& cloud)
{
  if (cloud.width == 0 || cloud.height == 0)
    return;
  if (cloud.is_bigendian)
    badParameter("cloud: its bytes are big-endian");
  const std::size_t row = std::size_t(cloud.width) * cloud.point_step;
  if (cloud.height > 1 && cloud.row_step < row)
    badParameter("cloud: row_step is ", cloud.row_step, ", expected at least ", row,
                 ": ", cloud.width, " points of ", cloud.point_step, " bytes");
  if (cloud.data.size() <
      std::size_t(cloud.height) * std::max<std::size_t>(row, cloud.row_step))
    badParameter("cloud: has ", cloud.data.size(), " bytes for ", cloud.width, " x ",
                 cloud.height, " points of ", cloud.point_step);
}

template <typename T>
void
put(PcdTable& table, const PcdField& field, const T* values)
{
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(values);
  table.setColumn(field, {bytes, bytes + table.points * field.bytes()});
}

// \param[in] count of its elements; 0 = any
PcdColumn
columnOf(const PcdTable& table, const std::string& name, int count = 1)
{
  const int index = table.find(name);
  const int found = index < 0 ? 0 : table.fields[std::size_t(index)].count;
  if (found == 0 || (count > 0 && found != count))
    badParameter("cloud: has no field '", name, "' of COUNT ", std::max(count, 1),
                 ", which a voxel cloud needs");
  return PcdColumn(table, index);
}

LabelDistributions
distributionsOf(const PcdTable& table, const std::string& name)
{
  const PcdColumn column = columnOf(table, name, 0);
  const int classes = column.field().count;
  LabelDistributions distributions(classes, Eigen::Index(table.points));
  for (std::size_t i = 0; i < table.points; ++i)
    for (int k = 0; k < classes; ++k)
      distributions.matrix()(k, Eigen::Index(i)) = float(column(i, k));
  return distributions;
}

} // namespace

void
toPCLPointCloud2(const PcdTable& table, pcl::PCLPointCloud2& cloud)
{
  const std::size_t step = table.pointSize();
  const bool organized = table.width > 0 && table.height > 0;
  if (table.points > std::size_t(std::numeric_limits<pcl::index_t>::max()) ||
      table.data.size() != table.points * step ||
      (organized && table.width * table.height != table.points))
    badParameter(table.data.size(), " bytes of data do not fit ", table.points,
                 " points of ", step);
  cloud = pcl::PCLPointCloud2();
  cloud.width = pcl::uindex_t(organized ? table.width : table.points);
  cloud.height = pcl::uindex_t(organized ? table.height : 1);
  cloud.point_step = pcl::uindex_t(step);
  cloud.row_step = pcl::uindex_t(step * cloud.width);
  std::size_t offset = 0;
  for (const PcdField& field : table.fields) {
    pcl::PCLPointField to;
    to.name = field.name;
    to.offset = pcl::uindex_t(offset);
    to.datatype = datatypeOf(field);
    to.count = pcl::uindex_t(field.count);
    cloud.fields.push_back(to);
    offset += field.bytes();
  }
  cloud.data = table.data;
  cloud.is_dense = true;
  for (const char* const axis : {"x", "y", "z"}) {
    const int field = table.find(axis);
    if (field < 0)
      continue;
    const PcdColumn column(table, field);
    for (std::size_t i = 0; i < table.points; ++i)
      cloud.is_dense = cloud.is_dense && std::isfinite(column(i));
  }
}

void
fromPCLPointCloud2(const pcl::PCLPointCloud2& cloud, PcdTable& table)
{
  requireBytes(cloud);
  table = PcdTable();
  table.width = cloud.width;
  table.height = cloud.height;
  table.points = std::size_t(cloud.width) * cloud.height;
  std::vector<std::size_t> offsets;
  for (const pcl::PCLPointField& from : cloud.fields) {
    if (from.name == "_")
      continue;
    const PcdField field = fieldOf(from);
    if (table.find(field.name) >= 0)
      badParameter("cloud: has two fields '", field.name, "'");
    // Filters that leave no point leave no point_step either.
    if (table.points > 0 && from.offset + field.bytes() > cloud.point_step)
      badParameter("cloud: field '", field.name, "' ends beyond its point");
    table.fields.push_back(field);
    offsets.push_back(from.offset);
  }
  table.data.resize(table.points * table.pointSize());
  std::uint8_t* to = table.data.data();
  for (std::size_t row = 0; row < cloud.height; ++row)
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const std::uint8_t* const point =
          cloud.data.data() + row * cloud.row_step + column * cloud.point_step;
      for (std::size_t f = 0; f < offsets.size(); ++f)
        to = std::copy_n(point + offsets[f], table.fields[f].bytes(), to);
    }
}

void
toPCLPointCloud2(const VoxelCloud& voxels, pcl::PCLPointCloud2& cloud)
{
  const auto size = Eigen::Index(voxels.size());
  if (voxels.cloud->size() != voxels.size() || voxels.measured.size() != size ||
      voxels.refined.size() != size || voxels.observations.size() != voxels.size())
    badParameter("the arrays of a voxel cloud differ in length");
  Eigen::Matrix3Xf points(3, size);
  Eigen::Matrix3Xi indices(3, size);
  std::vector<std::uint32_t> colours, labels;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    points.col(Eigen::Index(i)) = point.getVector3fMap();
    indices.col(Eigen::Index(i)) = voxels.indices[i].matrix();
    colours.push_back(point.rgba);
    labels.push_back(point.label);
  }
  const Eigen::Matrix3Xd origins = voxels.origin.replicate(1, size);
  const std::vector<double> sizes(voxels.size(), voxels.voxel_size);
  PcdTable table;
  table.points = voxels.size();
  table.fields = {{"x"}, {"y"}, {"z"}};
  table.data.resize(table.points * table.pointSize());
  if (size > 0)
    std::memcpy(table.data.data(), points.data(), table.data.size());
  put(table, {"rgba", 'U'}, colours.data());
  put(table, {"label", 'U'}, labels.data());
  put(table, {"probability", 'F', 4, std::max(1, voxels.refined.classes())},
      voxels.refined.matrix().data());
  put(table, {"measured", 'F', 4, std::max(1, voxels.measured.classes())},
      voxels.measured.matrix().data());
  put(table, {"observations", 'U'}, voxels.observations.data());
  put(table, {"index", 'I', 4, 3}, indices.data());
  put(table, {"voxel_size", 'F', 8}, sizes.data());
  put(table, {"origin", 'F', 8, 3}, origins.data());
  toPCLPointCloud2(table, cloud);
  cloud.header = voxels.cloud->header;
}

void
fromPCLPointCloud2(const pcl::PCLPointCloud2& cloud, VoxelCloud& voxels)
{
  PcdTable table;
  fromPCLPointCloud2(cloud, table);
  voxels = VoxelCloud();
  if (table.fields.empty() && table.points == 0)
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
  for (std::size_t i = 0; i < table.points; ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() << float(x(i)), float(y(i)), float(z(i));
    point.rgba = colour.bits(i);
    point.label = std::uint32_t(label(i));
    voxels.cloud->push_back(point);
    voxels.indices.emplace_back(int(index(i, 0)), int(index(i, 1)), int(index(i, 2)));
    voxels.observations.push_back(std::uint32_t(observations(i)));
  }
  if (table.points > 0) {
    voxels.voxel_size = size(0);
    voxels.origin << origin(0, 0), origin(0, 1), origin(0, 2);
  }
}

} // namespace pcl_semantic
