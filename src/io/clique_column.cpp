// SPDX-License-Identifier: BSD-3-Clause
#include "clique_column.h"

#include <pcl_semantic/core/exceptions.h>

#include <pcl/common/point_tests.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr const char* kField = "clique";

} // namespace

PcdColumn
singleColumn(const std::string& path, const PcdTable& table, int field)
{
  const PcdColumn column(table, field);
  if (column.field().count != 1)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": field '" << column.field().name << "' has COUNT "
                             << column.field().count << ", expected 1");
  return column;
}

void
badPcdValue(const std::string& path, const PcdColumn& column, std::size_t point,
            double value, const std::string& expected)
{
  PCL_THROW_EXCEPTION(BadInputException, path << ": field '" << column.field().name
                                              << "' of point " << point << " is "
                                              << value << ", expected " << expected);
}

std::uint32_t
wholeNumber(const std::string& path, const PcdColumn& column, std::size_t point,
            std::uint32_t largest)
{
  const double value = column(point);
  if (!(value >= 0.0 && value <= largest) || value != std::floor(value))
    badPcdValue(path, column, point, value,
                "a whole number from 0 to " + std::to_string(largest));
  return static_cast<std::uint32_t>(value);
}

std::vector<pcl::PointIndices>
cliquesOfColumn(const std::string& path, const PcdTable& table,
                const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  const int field = table.find(kField);
  if (field < 0)
    return {};
  const PcdColumn column = singleColumn(path, table, field);
  std::vector<std::pair<std::uint32_t, pcl::index_t>> members; // clique, point
  for (std::size_t i = 0; i < table.points; ++i) {
    const std::uint32_t number =
        wholeNumber(path, column, i, std::numeric_limits<std::uint32_t>::max());
    if (number != 0 && pcl::isXYZFinite(cloud[i]))
      members.emplace_back(number, static_cast<pcl::index_t>(i));
  }
  std::sort(members.begin(), members.end());
  std::vector<pcl::PointIndices> cliques;
  for (std::size_t m = 0; m < members.size(); ++m) {
    if (m == 0 || members[m].first != members[m - 1].first)
      cliques.emplace_back();
    cliques.back().indices.push_back(members[m].second);
  }
  return cliques;
}

bool
sameCliques(const std::vector<pcl::PointIndices>& a,
            const std::vector<pcl::PointIndices>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const pcl::PointIndices& x, const pcl::PointIndices& y) {
                      return x.indices == y.indices;
                    });
}

void
setCliqueColumn(const std::string& path, const std::vector<pcl::PointIndices>& cliques,
                PcdTable& table)
{
  std::vector<std::uint32_t> numbers(table.points, 0);
  std::uint32_t number = 0;
  for (const pcl::PointIndices& clique : cliques) {
    ++number;
    for (const pcl::index_t index : clique.indices) {
      if (index < 0 || static_cast<std::size_t>(index) >= table.points)
        PCL_THROW_EXCEPTION(InvalidParameterException, path << ": clique " << number - 1
                                                            << " has point " << index
                                                            << " of " << table.points);
      std::uint32_t& entry = numbers[static_cast<std::size_t>(index)];
      if (entry != 0)
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            path << ": point " << index << " is in cliques "
                                 << entry - 1 << " and " << number - 1
                                 << ", but a field holds one");
      entry = number;
    }
  }
  std::vector<std::uint8_t> bytes(numbers.size() * sizeof(std::uint32_t));
  if (!numbers.empty())
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
  table.setColumn({kField, 'U'}, bytes);
}

} // namespace pcl_semantic
