// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/map_reader.h>
#include <pcl_semantic/map/block_store.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

enum class ArchiveAccess { read, write };

/** \brief A map in one SQLite file, behind the interface by which a SemanticVoxelMap
 * keeps the blocks that leave its window; doc/map.md has the layout.
 *
 * Blocks are put at any time and become part of the file together, by commit(): after
 * a crash the file holds what the last commit left. One program writes, from beginning
 * to end; any number may read and see what was last committed before they opened it.
 * Everything stored carries a checksum that covers the place it belongs to: damage is
 * reported, never read as a map. Not for network file systems.
 *
 * All methods may be called by several threads. They throw
 * OutputException (disk full, read-only, another writer) or BadInputException (a
 * damaged file) with the name of the file and, where it is one, the block. After an
 * OutputException nothing more is written: the file stays as it was last committed. */
class MapArchive : public BlockStore, public MapReader {
public:
  /** \brief Makes a new file that holds an empty map, and opens it for writing.
   * \throws OutputException also if the file is there already */
  static std::shared_ptr<MapArchive> create(const std::string& path,
                                            const ArchiveHeader& header);

  MapArchive(const std::string& path, ArchiveAccess access);

  /** \brief Discards uncommitted changes. */
  ~MapArchive() override;

  void put(const VoxelIndex& block, const VoxelBlock& content) override;

  std::unique_ptr<VoxelBlock> get(const VoxelIndex& block) const override;

  std::vector<std::unique_ptr<VoxelBlock>>
  get(const std::vector<VoxelIndex>& blocks) const override;

  /** \copydoc MapReader::forEach
   * \param[in] visit must not put */
  void forEach(const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit)
      const override;

  void forEachIndex(const std::function<void(const VoxelIndex&)>& visit) const override;

  bool contains(const VoxelIndex& block) const override;

  /** \brief Adds what a run keeps of a frame, for the next commit; replaces what was
   * kept of it. */
  void putFrame(int number, const std::vector<std::uint8_t>& record);

  /** \brief Visits the frames in the order of their numbers. */
  void forEachFrame(
      const std::function<void(int, const std::vector<std::uint8_t>&)>& visit) const;

  /** \brief Brings everything put so far to the disk, all or nothing.
   * \param[in] state its counts are set here */
  void commit(ArchiveState state);

  /** \brief Ends writing: what was committed is then in one file, which can be read
   * from read-only media. What was not is lost. Once only.
   * \return false if a reader remained: FILE-wal then belongs to the file until it
   * is written, and ended, again */
  bool close();

  const std::string& path() const override;

  const ArchiveHeader& header() const override;

  ArchiveState state() const override;

private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/** \brief A digest of all that a merge takes from an archive: its configuration, its
 * origin and its blocks. It tells what was changed by mistake, not what was forged.
 * \throws BadInputException */
std::uint64_t archiveDigest(const std::string& path);

/** \brief Reads all of an archive, or of the archives of an index of tiles, and
 * compares it with its checksums and counts. \return what is wrong, a line each; empty
 * if nothing is \throws BadInputException if it cannot be read, or is no archive at all
 */
std::vector<std::string> verifyArchive(const std::string& path,
                                       const BlockProgress& progress = nullptr);

} // namespace pcl_semantic
