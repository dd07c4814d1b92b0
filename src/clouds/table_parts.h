// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/cloud_size.h"

#include <pcl_semantic/clouds/pcd_table.h>
#include <pcl_semantic/core/export.h>

#include <pcl/PointIndices.h>
#include <pcl/conversions.h>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Name of PCL's padding fields, which may occur several times. */
constexpr const char* kPadding = "_";

/** \brief Checks that a table can be written: valid fields with unique names, and data
 * of the right size.
 * \param[in] path for the message
 * \throws InvalidParameterException if it cannot */
void checkTable(const std::string& path, const PcdTable& table);

/** \brief Calls \a use with a zero of the type of a field. */
template <typename Use>
auto
withTypeOf(const pcl::PCLPointField& field, Use&& use)
{
  using Field = pcl::PCLPointField;
  switch (field.datatype) {
  case Field::INT8:
    return use(std::int8_t());
  case Field::INT16:
    return use(std::int16_t());
  case Field::UINT16:
    return use(std::uint16_t());
  case Field::INT32:
    return use(std::int32_t());
  case Field::UINT32:
    return use(std::uint32_t());
  case Field::INT64:
    return use(std::int64_t());
  case Field::UINT64:
    return use(std::uint64_t());
  case Field::FLOAT32:
    return use(float());
  case Field::FLOAT64:
    return use(double());
  default: // UINT8, BOOL
    return use(std::uint8_t());
  }
}

/** \brief Converts a PCL cloud with its viewpoint.
 * \param[in] offset to add to the positions [m]; unless it is zero, they are written as
 * doubles
 * \throws InvalidParameterException if its size is not that of its points */
template <typename PointT>
PcdTable
tableOfPoints(const pcl::PointCloud<PointT>& cloud, const Eigen::Vector3d& offset)
{
  requireCloudSize(cloud);
  PcdTable table;
  pcl::toPCLPointCloud2(cloud, table);
  const char* const names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3 && !offset.isZero(0.0); ++axis) {
    std::vector<double> values;
    for (const PointT& point : cloud)
      values.push_back(double(point.data[axis]) + offset[axis]);
    table.setColumn(names[axis], values);
  }
  const Eigen::Vector4f& origin = cloud.sensor_origin_;
  const Eigen::Quaternionf& q = cloud.sensor_orientation_;
  table.viewpoint = {origin[0], origin[1], origin[2], q.w(), q.x(), q.y(), q.z()};
  return table;
}

/** \brief Sets the field `clique` from cliques, numbered from 1.
 * \param[in] name of the cloud, for messages
 * \throws InvalidParameterException if they overlap, or an index is out of range */
void setCliqueColumn(const std::string& name,
                     const std::vector<pcl::PointIndices>& cliques, PcdTable& table);

} // namespace pcl_semantic
