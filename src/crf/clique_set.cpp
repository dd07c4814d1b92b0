// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/clique_set.h>

#include <limits>
#include <numeric>

namespace pcl_semantic {

namespace {

constexpr std::size_t largest = std::numeric_limits<std::int32_t>::max();

// last_clique[i] is the clique that variable i was last seen in.
void
validate(const std::vector<std::int32_t>& members, std::size_t clique,
         std::vector<std::int32_t>& last_clique)
{
  if (members.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException, "clique " << clique << " is empty");
  for (const std::int32_t i : members) {
    if (i < 0 || std::size_t(i) >= last_clique.size())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "clique " << clique << " has the member " << i
                                    << ", expected 0 to less than "
                                    << last_clique.size());
    if (last_clique[std::size_t(i)] == std::int32_t(clique))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "clique " << clique << " has the member " << i << " twice");
    last_clique[std::size_t(i)] = std::int32_t(clique);
  }
}

// The rows of each index instead of the indices of each row.
IndexLists
transpose(const IndexLists& lists, std::size_t rows)
{
  IndexLists result;
  result.starts.assign(rows + 1, 0);
  for (const std::int32_t i : lists.indices)
    ++result.starts[std::size_t(i) + 1];
  std::partial_sum(result.starts.begin(), result.starts.end(), result.starts.begin());
  result.indices.resize(lists.indices.size());
  std::vector<std::size_t> next(result.starts.begin(), result.starts.end() - 1);
  for (std::size_t row = 0; row < lists.size(); ++row)
    for (const std::int32_t i : lists[row])
      result.indices[next[std::size_t(i)]++] = std::int32_t(row);
  return result;
}

} // namespace

CliqueSet::CliqueSet(const std::vector<std::vector<std::int32_t>>& cliques,
                     std::size_t variables)
{
  if (variables > largest || cliques.size() > largest)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        cliques.size()
                            << " cliques over " << variables
                            << " variables, expected less than 2^31 of each");
  std::vector<std::int32_t> last_clique(variables, -1);
  members_.starts.reserve(cliques.size() + 1);
  for (std::size_t c = 0; c < cliques.size(); ++c) {
    validate(cliques[c], c, last_clique);
    members_.starts.push_back(members_.starts.back() + cliques[c].size());
  }
  members_.indices.reserve(members_.starts.back());
  for (const auto& clique : cliques)
    members_.indices.insert(members_.indices.end(), clique.begin(), clique.end());
  cliques_ = transpose(members_, variables);
}

} // namespace pcl_semantic
