// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/clouds/pcd_table.h>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The numbers of a field, all elements of a point together. */
inline std::vector<double>
columnOf(const PcdTable& table, const std::string& name)
{
  const PcdColumn column(table, table.find(name));
  std::vector<double> values;
  for (std::size_t i = 0; i < table.points(); ++i)
    for (int k = 0; k < int(column.field().count); ++k)
      values.push_back(column(i, k));
  return values;
}

} // namespace pcl_semantic
