// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/clique_file.h>

#include "core/parse_whole.h"

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/files/input_file.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

pcl::PointIndices
parseClique(const std::string& text, std::size_t points, const std::string& where)
{
  pcl::PointIndices clique;
  for (const std::string_view word : wordsOf(text)) {
    pcl::index_t index = 0;
    if (!parseWhole(word, index) || index < 0 || std::size_t(index) >= points)
      badInput(where, ": ", inQuotes(word),
               ", expected a point index from 0, less than ", points);
    clique.indices.push_back(index);
  }
  std::sort(clique.indices.begin(), clique.indices.end());
  const auto twice = std::adjacent_find(clique.indices.begin(), clique.indices.end());
  if (twice != clique.indices.end())
    badInput(where, ": names point ", *twice, " twice");
  return clique;
}

} // namespace

std::vector<pcl::PointIndices>
readCliques(const std::string& path, std::size_t points)
{
  std::vector<pcl::PointIndices> cliques;
  for (const TextLine& line : readLines(path)) {
    pcl::PointIndices clique = parseClique(line.text.substr(0, line.text.find('#')),
                                           points, atLine(path, line.number));
    if (!clique.indices.empty()) // a line may contain only blanks or a comment
      cliques.push_back(std::move(clique));
  }
  return cliques;
}

} // namespace pcl_semantic
