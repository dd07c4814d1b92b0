// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/pcd_table.h>

#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A field of one element. \throws BadInputException if it has more */
PcdColumn singleColumn(const std::string& path, const PcdTable& table, int field);

/** \brief Says that a value of a field is not what was expected.
 * \throws BadInputException */
[[noreturn]] void badPcdValue(const std::string& path, const PcdColumn& column,
                              std::size_t point, double value,
                              const std::string& expected);

/** \brief A value of a field. \throws BadInputException unless it is a whole number
 * from 0 to \a largest */
std::uint32_t wholeNumber(const std::string& path, const PcdColumn& column,
                          std::size_t point, std::uint32_t largest);

/** \brief The finite points of each number of the field `clique` but 0, in the order of
 * the numbers; none without that field. \throws BadInputException */
std::vector<pcl::PointIndices>
cliquesOfColumn(const std::string& path, const PcdTable& table,
                const pcl::PointCloud<pcl::PointXYZRGBL>& cloud);

/** \brief Whether two lists of cliques hold the same points in the same order. */
bool sameCliques(const std::vector<pcl::PointIndices>& a,
                 const std::vector<pcl::PointIndices>& b);

/** \brief Puts cliques into the field `clique`: the first is number 1.
 * \throws InvalidParameterException if an index is out of range or two overlap */
void setCliqueColumn(const std::string& path,
                     const std::vector<pcl::PointIndices>& cliques, PcdTable& table);

} // namespace pcl_semantic
