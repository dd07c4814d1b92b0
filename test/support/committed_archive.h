// SPDX-License-Identifier: BSD-3-Clause

// A writer with several commits, for tests that interrupt it.

#pragma once

#include "support/archives.h"

namespace pcl_semantic {

/** \brief The blocks after \a commits commits, four each. */
inline Blocks
blocksAfter(int commits)
{
  Blocks blocks;
  for (unsigned i = 0; i < 4u * unsigned(commits); ++i)
    blocks[VoxelIndex(int(i), 0, 0)] = makeRandomBlock(20, 3, i);
  return blocks;
}

/** \brief Puts the blocks of each of the next commits into an archive and closes it.
 * \param[out] done number of completed commits
 * \param[in] after called after each */
inline void
commitTimes(
    int commits, MapArchive& archive, int& done,
    const std::function<void()>& after = [] {})
{
  for (int commit = 1; commit <= commits; ++commit) {
    putAll(blocksAfter(commit), archive);
    archive.commit({});
    done = commit;
    after();
  }
  archive.close();
}

/** \brief EXPECTs the map after these commits, or after the one in progress. */
inline void
expectCommitted(const MapArchive& archive, int commits)
{
  int blocks = 0;
  archive.forEach([&](const VoxelIndex&, const VoxelBlock&) { ++blocks; });
  const int found = blocks / 4;
  EXPECT_TRUE(found == commits || found == commits + 1) << blocks;
  expectHolds(archive, blocksAfter(found));
}

} // namespace pcl_semantic
