// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PointIndices.h>

#include <cstddef>
#include <vector>

namespace pcl_semantic {

using Cliques = std::vector<std::vector<int>>;

inline Cliques
listsOf(const std::vector<pcl::PointIndices>& cliques)
{
  Cliques lists;
  for (const pcl::PointIndices& clique : cliques)
    lists.emplace_back(clique.indices.begin(), clique.indices.end());
  return lists;
}

inline std::size_t
membersOf(const Cliques& cliques)
{
  std::size_t count = 0;
  for (const std::vector<int>& clique : cliques)
    count += clique.size();
  return count;
}

} // namespace pcl_semantic
