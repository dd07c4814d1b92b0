// SPDX-License-Identifier: BSD-3-Clause
#include "support/mutate.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/clique_file.h>

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

using Lists = std::vector<pcl::Indices>;

Lists
listsOf(const std::vector<pcl::PointIndices>& cliques)
{
  Lists lists;
  for (const pcl::PointIndices& clique : cliques)
    lists.push_back(clique.indices);
  return lists;
}

Lists
read(const std::string& text, std::size_t points = 1000)
{
  const TemporaryFolder folder;
  return listsOf(readCliques(folder.write("a.txt", text), points));
}

// EXPECT that a file whose second line is bad is refused with it and the part.
::testing::AssertionResult
refuses(const std::string& line, const std::string& part)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("cliques.txt", "0 1\n" + line + "\n2 3\n");
  const std::string message =
      thrownMessage<BadInputException>([&] { readCliques(path, 1000); });
  EXPECT_TRUE(holds(message, path + " line 2: "));
  return holds(message, part);
}

} // namespace

TEST(CliqueFile, ReadsListsBlanksAndComments)
{
  EXPECT_EQ(read("# two\n\n3 1 2\r\n  \t\n 999\t0 # why\n#5 6\n1"),
            (Lists{{1, 2, 3}, {0, 999}, {1}}));
  EXPECT_EQ(read(""), Lists());
  EXPECT_EQ(read("# nothing\n"), Lists());
  EXPECT_EQ(read("2147483646", 2147483647), Lists{{2147483646}});
}

TEST(CliqueFile, NamesTheLineOfABadIndex)
{
  for (const std::string word : {"-1", "x", "1.0", "1e2", "2147483648", "0x1", "+1",
                                 "1,2", "nan", "\x01", "99999999999999999999"})
    EXPECT_TRUE(refuses("4 " + word, "is not the index of a point")) << word;
  EXPECT_TRUE(refuses("5 1000", "'1000' is not the index of a point, expected a number "
                                "from 0, below 1000"));
  EXPECT_TRUE(refuses("5 2 7 5", "point 5 twice"));
}

TEST(CliqueFile, NoPointsHaveNoCliques)
{
  EXPECT_EQ(read("# none\n", 0), Lists());
  thrownMessage<BadInputException>([] { read("0\n", 0); });
  thrownMessage<BadInputException>([] { readCliques("/no/such.txt"); });
}

TEST(CliqueFile, DamagedFilesAreReadOrRefused)
{
  const TemporaryFolder folder;
  Mutator mutate(3, {"-1", "#", "2147483648", "\n", " ", "1.5", "7", "40"});
  int read_well = 0, refused = 0;
  for (int i = 0; i < 300; ++i) {
    const std::string path =
        folder.write("a.txt", mutate("0 1 2 3\n4 5 6\n\n# seven\n7 8 9\n1 5 9\n"));
    try {
      for (const pcl::PointIndices& clique : readCliques(path, 40)) {
        ASSERT_FALSE(clique.indices.empty());
        for (const pcl::index_t index : clique.indices)
          ASSERT_TRUE(index >= 0 && index < 40);
      }
      ++read_well;
    }
    catch (const BadInputException&) {
      ++refused;
    }
  }
  EXPECT_GT(read_well, 30);
  EXPECT_GT(refused, 30);
}
