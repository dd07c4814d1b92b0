// SPDX-License-Identifier: BSD-3-Clause
#include "archive_database.h"
#include "archive_meta.h"
#include "block_counter.h"
#include "block_encoding.h"

#include <pcl_semantic/io/map_archive.h>

namespace pcl_semantic {

namespace {

class Verifier {
public:
  Verifier(const std::string& path, const BlockProgress& progress)
      : database_(path, ArchiveDatabase::Access::read), progress_(progress)
  {}

  std::vector<std::string>
  faults()
  {
    check([&] {
      for (const std::string& fault : database_.integrityFaults())
        found_.push_back(database_.path() + ": is damaged: " + fault);
    });
    check([&] { checkContent(); });
    return found_;
  }

private:
  // Keeps what is thrown as a fault.
  template <typename Check>
  void
  check(Check&& body)
  {
    try {
      body();
    }
    catch (const BadInputException& error) {
      found_.push_back(error.what());
    }
  }

  void
  checkContent()
  {
    const int classes = readHeader(database_).label_set.size();
    const ArchiveState state = readState(database_);
    check([&] { checkBlocks(state, classes); });
    check([&] { checkFrames(state); });
  }

  void
  checkBlocks(const ArchiveState& state, int classes)
  {
    BlockIndexSet keys;
    BlockCounter counter(progress_, state.blocks);
    database_.forEachBlock([&](const VoxelIndex& index, std::string_view sealed) {
      keys.insert(index);
      counter.step();
      check([&] {
        const Bytes content =
            database_.unsealBlock(index, {sealed.begin(), sealed.end()});
        readAt(database_.path() + ": " + nameOfBlock(index),
               [&] { decodeBlock(content, index, classes); });
      });
    });
    checkBlockKeys(database_.path(), keys, state);
  }

  void
  checkFrames(const ArchiveState& state)
  {
    checkFrameCount(database_, state);
    database_.forEachFrame([](int, const Bytes&) {});
  }

  ArchiveDatabase database_;
  const BlockProgress& progress_;
  std::vector<std::string> found_;
};

} // namespace

std::vector<std::string>
verifyArchive(const std::string& path, const BlockProgress& progress)
{
  return Verifier(path, progress).faults();
}

} // namespace pcl_semantic
