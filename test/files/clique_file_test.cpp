// SPDX-License-Identifier: BSD-3-Clause
#include "support/clique_lists.h"
#include "support/refused_file.h"

#include <pcl_semantic/files/clique_file.h>

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

Cliques
read(const std::string& text, std::size_t points = 1000)
{
  const TemporaryFolder folder;
  return listsOf(readCliques(folder.write("a.txt", text), points));
}

::testing::AssertionResult
refuses(const std::string& line, const std::string& part)
{
  return refusesFile("cliques.txt", "0 1\n" + line + "\n2 3\n",
                     "cliques.txt line 2: " + part,
                     [](const std::string& path) { readCliques(path, 1000); });
}

} // namespace

TEST(CliqueFile, ReadsListsBlanksAndComments)
{
  EXPECT_EQ(read("# two\n\n3 1 2\r\n  \t\f\v\n 999\t0 # why\n#5 6\n1"),
            (Cliques{{1, 2, 3}, {0, 999}, {1}}));
  EXPECT_EQ(read(""), Cliques());
  EXPECT_EQ(read("# nothing\n"), Cliques());
  EXPECT_EQ(read("2147483646", 2147483647), Cliques{{2147483646}});
}

TEST(CliqueFile, NamesTheLineOfABadIndex)
{
  for (const std::string word : {"-1", "x", "1.0", "1e2", "2147483648", "0x1", "+1",
                                 "1,2", "nan", "\x01", "99999999999999999999"})
    EXPECT_TRUE(refuses("4 " + word, "'" + (word == "\x01" ? "?" : word) +
                                         "', expected a point index"));
  EXPECT_TRUE(
      refuses("5 1000", "'1000', expected a point index from 0, less than 1000"));
  EXPECT_TRUE(refuses("5 2 7 5", "names point 5 twice"));
}

TEST(CliqueFile, NoPointsHaveNoCliques)
{
  EXPECT_EQ(read("# none\n", 0), Cliques());
  thrownMessage<BadInputException>([] { read("0\n", 0); });
  thrownMessage<BadInputException>([] { readCliques("/no/such.txt"); });
}
