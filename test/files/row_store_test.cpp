// SPDX-License-Identifier: BSD-3-Clause
#include "files/row_store.h"

#include "support/process_limits.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>

#include <filesystem>
#include <random>

using namespace pcl_semantic;

TEST(RowStore, KeepsTheRowsOfEachBucketInTheirOrder)
{
  const TemporaryFolder folder;
  std::mt19937 random(3);
  for (const std::size_t size : {1, 17, 70000})
    for (const std::size_t buckets : {1, 3, 100}) {
      RowStore store(folder.path(""), size, buckets);
      std::vector<std::vector<std::uint8_t>> expected(buckets);
      const std::size_t rows = size > 1000 ? 300 : 100000;
      for (std::size_t i = 0; i < rows; ++i) {
        const std::size_t bucket = random() % buckets;
        const std::vector<std::uint8_t> row(size, std::uint8_t(random()));
        store.append(bucket, row.data());
        expected[bucket].insert(expected[bucket].end(), row.begin(), row.end());
      }
      for (std::size_t b = 0; b < buckets; ++b)
        EXPECT_TRUE(store.read(b) == expected[b]) << size << " " << b;
      EXPECT_TRUE(std::filesystem::is_empty(folder.path("")));
    }
}

TEST(RowStore, ReportsAFolderWithoutRoom)
{
  const TemporaryFolder folder;
  EXPECT_THROW(RowStore(folder.path("missing"), 8, 1), OutputException);
  const FullDisk full(1 << 20);
  RowStore store(folder.path(""), 8, 1);
  const std::vector<std::uint8_t> row(8, 1);
  EXPECT_THROW(
      {
        for (int i = 0; i < 1000000; ++i)
          store.append(0, row.data());
      },
      OutputException);
}
