// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_reader.h"

#include "support/ascii_cloud.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

using namespace pcl_semantic;

namespace {

class PcdReaderTest : public testing::Test {
protected:
  PcdReaderTest()
  {
    table.width = 10;
    table.height = 10;
    std::vector<float> numbers(100);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      numbers[i] = float(i);
    for (const char* const name : {"x", "y", "z", "other"})
      table.setColumn(name, numbers);
    writeCloudTable(path, table);
  }

  void
  append(std::size_t bytes, char value)
  {
    std::ofstream(path, std::ios::binary | std::ios::app) << std::string(bytes, value);
  }

  const TemporaryFolder folder;
  const std::string path = folder.path("cloud.pcd");
  PcdTable table;
};

} // namespace

TEST_F(PcdReaderTest, ReadsAnyPart)
{
  PcdReader reader(path);
  EXPECT_EQ(reader.size(), 100u);
  EXPECT_EQ(reader.header().width, 10u);
  EXPECT_TRUE(reader.header().data.empty());
  for (const auto& [first, count] :
       {std::pair(0, 100), std::pair(40, 3), std::pair(99, 1), std::pair(100, 0)}) {
    const PcdTable part = reader.read(std::size_t(first), std::size_t(count));
    EXPECT_EQ(part.points(), std::size_t(count));
    EXPECT_TRUE(std::equal(part.data.begin(), part.data.end(),
                           table.data.begin() + first * int(table.point_step)));
  }
  EXPECT_THROW(reader.read(99, 2), InvalidParameterException);
}

TEST_F(PcdReaderTest, RefusesWhatTheWholeReaderRefuses)
{
  append(100, '\0'); // PCL's padding
  EXPECT_EQ(PcdReader(path).size(), 100u);
  append(1, 'x');
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { PcdReader reader(path); }),
                    "101 bytes behind the data"));
  append(100000, '\0');
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { PcdReader reader(path); }),
                    "100101 bytes behind the data"));
  std::filesystem::resize_file(path, 700);
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { PcdReader reader(path); }),
                    "expected 100 points of 16 bytes"));
  EXPECT_THROW(PcdReader(folder.path("missing.pcd")), BadInputException);
}

TEST_F(PcdReaderTest, ReportsAFileThatShrinks)
{
  PcdReader reader(path);
  std::filesystem::resize_file(path, 700);
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { reader.read(0, 100); }),
                    "cannot be read beyond byte 700"));
}

TEST_F(PcdReaderTest, TellsWhichFilesHaveParts)
{
  EXPECT_TRUE(PcdReader::canRead(path));
  folder.write("ascii.pcd", asciiCloud("x y z", "1 2 3\n"));
  EXPECT_FALSE(PcdReader::canRead(folder.path("ascii.pcd")));
  EXPECT_THROW(PcdReader(folder.path("ascii.pcd")), BadInputException);
  EXPECT_FALSE(PcdReader::canRead(folder.path("cloud.ply")));
}
