// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/map_archive.h>

#include "archive_database.h"
#include "archive_meta.h"
#include "archive_objects.h"
#include "block_encoding.h"
#include "core/digest.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "files/bytes.h"
#include "tiled_map.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

using IndexedBlocks = std::vector<std::pair<VoxelIndex, const VoxelBlock*>>;

// Beyond this size, pending blocks are written to the open transaction, which limits
// memory. [bytes]
constexpr std::size_t kMaxPending = std::size_t(32) << 20;

constexpr std::size_t kBlocksAtATime =
    256; // blocks that are read, and then decompressed in parallel

// Seals each block, in parallel; the result does not depend on the number of threads.
std::vector<Bytes>
sealBlocks(const IndexedBlocks& blocks, int classes)
{
  std::vector<Bytes> sealed(blocks.size());
  ParallelGuard guard;
#pragma omp parallel
  {
    std::optional<Sealer> sealer; // one per thread
#pragma omp for schedule(dynamic, 16)
    for (std::size_t i = 0; i < blocks.size(); ++i)
      guard.run([&] {
        if (!sealer)
          sealer.emplace();
        sealed[i] =
            sealer->seal(encodeBlock(blocks[i].first, *blocks[i].second, classes));
      });
  }
  guard.rethrow();
  return sealed;
}

} // namespace

struct MapArchive::Implementation {
  Implementation(const std::string& path, ArchiveAccess access)
      : database(path, access == ArchiveAccess::read ? ArchiveDatabase::Access::read
                                                     : ArchiveDatabase::Access::write)
  {
    header = readHeader(database);
    state = readState(database);
    stored = readBlockKeys(database, state);
    checkFrameCount(database, state);
    writable = access == ArchiveAccess::write;
  }

  void
  requireWritable() const
  {
    if (!writable)
      fail<OutputException>(database.path(), ": is not open for writing");
  }

  // Runs a write. After a failure the transaction may be gone, and a later commit would
  // store only a part of it.
  template <typename Write>
  void
  write(Write&& body)
  {
    requireWritable();
    try {
      body();
    }
    catch (...) {
      writable = false;
      throw;
    }
  }

  IndexedBlocks
  pendingInOrder() const
  {
    IndexedBlocks blocks;
    for (const auto& [index, block] : pending)
      blocks.emplace_back(index, &block);
    std::sort(blocks.begin(), blocks.end(), [](const auto& a, const auto& b) {
      return VoxelIndexLess()(a.first, b.first);
    });
    return blocks;
  }

  void
  writePending()
  {
    const IndexedBlocks blocks = pendingInOrder();
    const std::vector<Bytes> sealed = sealBlocks(blocks, header.label_set.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      database.putBlock(blocks[i].first, sealed[i]);
      stored.insert(blocks[i].first);
    }
    pending.clear();
    pending_bytes = 0;
  }

  std::unique_ptr<VoxelBlock>
  decode(const VoxelIndex& index, const Bytes& content) const
  {
    return readAt(database.path() + ": " + nameOfBlock(index),
                  [&] { return decodeBlock(content, index, header.label_set.size()); });
  }

  std::string
  sealed(const VoxelIndex& block)
  {
    std::optional<std::string> found = database.getBlock(block);
    if (!found)
      badInput(database.path(), ": is damaged: lacks ", nameOfBlock(block));
    return std::move(*found);
  }

  // Decompresses blocks in parallel.
  std::vector<std::unique_ptr<VoxelBlock>>
  open(const std::vector<std::pair<VoxelIndex, std::string>>& sealed) const
  {
    std::vector<std::unique_ptr<VoxelBlock>> blocks(sealed.size());
    ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 16)
    for (std::size_t i = 0; i < sealed.size(); ++i)
      guard.run([&] {
        const auto& [index, bytes] = sealed[i];
        blocks[i] = decode(index, database.unsealBlock(index, bytes));
      });
    guard.rethrow();
    return blocks;
  }

  ArchiveDatabase database;
  ArchiveHeader header;
  ArchiveState state;
  BlockIndexSet stored; // in the file, or in the open transaction
  std::unordered_map<VoxelIndex, VoxelBlock, VoxelIndexHash> pending;
  std::size_t pending_bytes = 0;
  bool writable = false;
  std::recursive_mutex mutex; // recursive, because a visitor may request other blocks
};

std::unique_ptr<MapReader>
MapReader::open(const std::string& path)
{
  if (TiledMap::isIndex(path))
    return std::make_unique<TiledMap>(path);
  return std::make_unique<MapArchive>(path, ArchiveAccess::read);
}

std::shared_ptr<MapArchive>
MapArchive::create(const std::string& path, const ArchiveHeader& header)
{
  ArchiveDatabase::create(path, [&](ArchiveDatabase& database) {
    writeHeader(database, header);
    writeState(database, {});
  });
  return std::make_shared<MapArchive>(path, ArchiveAccess::write);
}

MapArchive::MapArchive(const std::string& path, ArchiveAccess access)
    : implementation_(std::make_unique<Implementation>(path, access))
{}

MapArchive::~MapArchive()
{
  try {
    if (implementation_->writable)
      close();
  }
  catch (const std::exception&) { // the file stays at the last commit anyway
  }
}

void
MapArchive::put(const VoxelIndex& block, const VoxelBlock& content)
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  my.requireWritable();
  VoxelBlock copy = content; // first, so that std::bad_alloc changes nothing
  const std::size_t bytes = memoryOf(copy);
  const auto [found, is_new] = my.pending.try_emplace(block, std::move(copy));
  if (!is_new) {
    my.pending_bytes -= memoryOf(found->second);
    found->second = std::move(copy); // try_emplace has not moved from it
  }
  my.pending_bytes += bytes;
  if (my.pending_bytes > kMaxPending)
    my.write([&] { my.writePending(); });
}

std::unique_ptr<VoxelBlock>
MapArchive::get(const VoxelIndex& block) const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  const auto waiting = my.pending.find(block);
  if (waiting != my.pending.end())
    return std::make_unique<VoxelBlock>(waiting->second);
  if (!my.stored.contains(block))
    return nullptr;
  return std::move(my.open({{block, my.sealed(block)}}).front());
}

std::vector<std::unique_ptr<VoxelBlock>>
MapArchive::get(const std::vector<VoxelIndex>& blocks) const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  std::vector<std::unique_ptr<VoxelBlock>> found(blocks.size());
  std::vector<std::pair<VoxelIndex, std::string>> read;
  std::vector<std::size_t> places; // of the blocks that are read
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (my.pending.count(blocks[i]) > 0)
      found[i] = get(blocks[i]);
    else if (my.stored.contains(blocks[i])) {
      read.emplace_back(blocks[i], my.sealed(blocks[i]));
      places.push_back(i);
    }
  auto opened = my.open(read);
  for (std::size_t k = 0; k < places.size(); ++k)
    found[places[k]] = std::move(opened[k]);
  return found;
}

void
MapArchive::forEachIndex(const std::function<void(const VoxelIndex&)>& visit) const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  std::vector<VoxelIndex> indices;
  my.database.forEachBlockKey(
      [&](const VoxelIndex& index) { indices.push_back(index); });
  for (const auto& [index, block] : my.pending)
    if (!my.stored.contains(index))
      indices.push_back(index);
  std::sort(indices.begin(), indices.end(), VoxelIndexLess());
  for (const VoxelIndex& index : indices)
    visit(index);
}

bool
MapArchive::contains(const VoxelIndex& block) const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  return my.pending.count(block) > 0 || my.stored.contains(block);
}

void
MapArchive::forEach(
    const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  // Merges two ordered lists; pending blocks are newer.
  const IndexedBlocks waiting = my.pendingInOrder();
  auto next = waiting.begin();
  std::vector<std::pair<VoxelIndex, std::string>> read;
  const auto visitRead = [&] {
    const auto blocks = my.open(read);
    for (std::size_t i = 0; i < read.size(); ++i) {
      for (; next != waiting.end() && VoxelIndexLess()(next->first, read[i].first);
           ++next)
        visit(next->first, *next->second);
      visit(read[i].first, *blocks[i]);
    }
    read.clear();
  };
  std::uint64_t rows = 0;
  my.database.forEachBlock([&](const VoxelIndex& index, std::string_view row) {
    ++rows;
    if (my.pending.count(index) == 0)
      read.emplace_back(index, row);
    if (read.size() == kBlocksAtATime)
      visitRead();
  });
  visitRead();
  for (; next != waiting.end(); ++next)
    visit(next->first, *next->second);
  if (rows != my.stored.size())
    badInput(my.database.path(), ": is damaged: has ", rows, " blocks, expected ",
             my.stored.size());
}

void
MapArchive::putFrame(int number, const std::vector<std::uint8_t>& record)
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  my.write([&] { my.database.putFrame(number, record); });
}

void
MapArchive::forEachFrame(
    const std::function<void(int, const std::vector<std::uint8_t>&)>& visit) const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  my.database.forEachFrame(visit);
}

void
MapArchive::commit(ArchiveState state)
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  my.write([&] {
    my.writePending();
    state.blocks = my.stored.size();
    state.key_sum = my.stored.keySum();
    state.frames = my.database.countFrames();
    state.last_frame = my.database.lastFrame();
    writeState(my.database, state);
    my.database.commit();
    my.state = state;
  });
}

bool
MapArchive::close()
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  bool is_one_file = false;
  my.write([&] { is_one_file = my.database.close(); });
  my.writable = false;
  return is_one_file;
}

const std::string&
MapArchive::path() const
{
  return implementation_->database.path();
}

const ArchiveHeader&
MapArchive::header() const
{
  return implementation_->header;
}

ArchiveState
MapArchive::state() const
{
  const std::lock_guard<std::recursive_mutex> lock(implementation_->mutex);
  return implementation_->state;
}

void
MapArchive::putObjects(const MapObjects& objects)
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  my.write([&] { writeArchiveObjects(my.database, objects); });
}

std::optional<MapObjects>
MapArchive::objects() const
{
  Implementation& my = *implementation_;
  const std::lock_guard<std::recursive_mutex> lock(my.mutex);
  return readArchiveObjects(my.database, my.header.label_set.size());
}

namespace {

void
checkBlocks(ArchiveDatabase& database, int classes, const ArchiveState& state,
            const BlockProgress& progress,
            const std::function<void(const std::function<void()>&)>& check)
{
  BlockIndexSet keys;
  std::size_t done = 0;
  database.forEachBlock([&](const VoxelIndex& index, std::string_view sealed) {
    keys.insert(index);
    if (progress)
      progress(++done, state.blocks);
    check([&] {
      const Bytes content = database.unsealBlock(index, sealed);
      readAt(database.path() + ": " + nameOfBlock(index),
             [&] { decodeBlock(content, index, classes); });
    });
  });
  checkBlockKeys(database.path(), keys, state);
}

} // namespace

std::uint64_t
archiveDigest(const std::string& path)
{
  ArchiveDatabase database(path, ArchiveDatabase::Access::read);
  const std::string configuration = readHeader(database).configuration;
  const ArchiveState state = readState(database);
  Digest digest;
  digest.add(configuration.data(), configuration.size());
  digest.add(state.cloud_origin.data(), 3 * sizeof(double));
  digest.addWord(state.finished);
  database.forEachBlock([&](const VoxelIndex& index, std::string_view sealed) {
    digest.add(index.data(), 3 * sizeof(int));
    digest.add(sealed.data(), sealed.size());
  });
  return digest.value();
}

std::vector<std::string>
verifyArchive(const std::string& path, const BlockProgress& progress)
{
  if (TiledMap::isIndex(path))
    return TiledMap(path).faults(progress);
  ArchiveDatabase database(path, ArchiveDatabase::Access::read);
  std::vector<std::string> faults;
  const auto check = [&](const std::function<void()>& body) {
    try {
      body();
    }
    catch (const BadInputException& error) {
      faults.push_back(error.what());
    }
  };
  check([&] {
    for (const std::string& fault : database.integrityFaults())
      faults.push_back(path + ": is damaged: " + fault);
  });
  check([&] {
    const int classes = readHeader(database).label_set.size();
    const ArchiveState state = readState(database);
    check([&] { checkBlocks(database, classes, state, progress, check); });
    check([&] {
      checkFrameCount(database, state);
      database.forEachFrame([](int, const Bytes&) {});
    });
    check([&] { readArchiveObjects(database, classes); });
  });
  return faults;
}

} // namespace pcl_semantic
