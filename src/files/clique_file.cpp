// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/clique_file.h>

#include "parse_whole.h"

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/files/atomic_file.h>
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
               " is not the index of a point, expected a number from 0, below ",
               points);
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
    if (!clique.indices.empty()) // a line may hold blanks alone, or a comment
      cliques.push_back(std::move(clique));
  }
  return cliques;
}

void
writeCliques(const std::string& path, const std::vector<pcl::PointIndices>& cliques)
{
  AtomicFile file(path);
  for (std::size_t c = 0; c < cliques.size(); ++c) {
    const pcl::Indices& indices = cliques[c].indices;
    if (indices.empty() || *std::min_element(indices.begin(), indices.end()) < 0)
      badParameter(path, ": clique ", c, " is empty or has a negative index");
    const char* separator = "";
    for (const pcl::index_t index : indices) {
      file.stream() << separator << index;
      separator = " ";
    }
    file.stream() << '\n';
  }
  file.commit();
}

} // namespace pcl_semantic
