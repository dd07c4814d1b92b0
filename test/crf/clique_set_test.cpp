// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/crf_model.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pcl_semantic;
using Lists = std::vector<std::vector<std::int32_t>>;

Lists
unpacked(const IndexLists& lists)
{
  Lists result;
  for (std::size_t row = 0; row < lists.size(); ++row)
    result.emplace_back(lists[row].begin(), lists[row].end());
  return result;
}

TEST(CliqueSet, KeepsMembersAndKnowsTheCliquesOfVariables)
{
  const Lists cliques{{4, 0, 2}, {5}, {2, 3, 4}};
  const CliqueSet set(cliques, 7);
  EXPECT_EQ(set.size(), 3u);
  EXPECT_EQ(set.variables(), 7u);
  EXPECT_EQ(unpacked(set.members()), cliques);
  EXPECT_EQ(unpacked(set.cliques()), (Lists{{0}, {}, {0, 2}, {2}, {0, 2}, {1}, {}}));
}

TEST(CliqueSet, NoCliquesAndNoVariables)
{
  EXPECT_EQ(CliqueSet().size(), 0u);
  EXPECT_EQ(CliqueSet().variables(), 0u);
  EXPECT_EQ(CliqueSet({}, 0).size(), 0u);
  EXPECT_EQ(unpacked(CliqueSet({}, 2).cliques()), (Lists{{}, {}}));
}

TEST(CliqueSet, RefusesWhatIsNoClique)
{
  const auto refusal = [](const Lists& cliques) {
    return thrownMessage<InvalidParameterException>([&] { CliqueSet(cliques, 5); });
  };
  EXPECT_TRUE(
      holds(refusal({{0, 1}, {2, 5}}), "clique 1 has the member 5, expected 0 to"));
  EXPECT_TRUE(holds(refusal({{0, -1}}), "clique 0 has the member -1"));
  EXPECT_TRUE(holds(refusal({{0}, {1}, {}}), "clique 2 is empty"));
  EXPECT_TRUE(holds(refusal({{0, 1}, {3, 1, 3}}), "clique 1 has the member 3 twice"));
}

} // namespace
