// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/map_reader.h>
#include <pcl_semantic/map/block_store.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

enum class ArchiveAccess { read, write };

/** \brief A map in one SQLite file, usable as BlockStore of a SemanticVoxelMap.
 * doc/map.md describes the layout.
 *
 * Blocks can be put at any time and become part of the file together, by commit().
 * After a crash the file contains the last commit. Only one program can have the file
 * open for writing. Any number of programs may read. They see the last commit before
 * they opened the file. Every record has a checksum that includes its key, so that
 * damage is reported and never read as a map. Not for network file systems.
 *
 * All methods are thread-safe. They throw OutputException (disk full, read-only,
 * another writer) or BadInputException (damaged file) with the file name and, if
 * applicable, the block. After an OutputException nothing more is written: the file
 * stays at the last commit. */
class MapArchive : public BlockStore, public MapReader {
public:
  /** \brief Makes a new file with an empty map, and opens it for writing.
   * \throws OutputException also if the file exists */
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
   * \param[in] visit must not call put() */
  void forEach(const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit)
      const override;

  void forEachIndex(const std::function<void(const VoxelIndex&)>& visit) const override;

  bool contains(const VoxelIndex& block) const override;

  /** \brief Adds the record of a frame to the next commit; replaces an earlier one. */
  void putFrame(int number, const std::vector<std::uint8_t>& record);

  /** \brief Visits the frames in the order of their numbers. */
  void forEachFrame(
      const std::function<void(int, const std::vector<std::uint8_t>&)>& visit) const;

  /** \brief Writes all pending changes to disk, all or nothing.
   * \param[in] state the method replaces its counts */
  void commit(ArchiveState state);

  /** \brief Ends writing. All commits are then in one file, which can be read from
   * read-only media; uncommitted changes are lost. Call it only once.
   * \return false if a reader was still open: FILE-wal then belongs to the file until
   * it is written and closed again */
  bool close();

  const std::string& path() const override;

  const ArchiveHeader& header() const override;

  ArchiveState state() const override;

  /** \brief Adds the objects of the map to the next commit. Earlier ones are replaced,
   * kept if they are in MapObjects::unchanged, or else removed. */
  void putObjects(const MapObjects& objects);

  std::optional<MapObjects> objects() const override;

private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/** \brief A checksum over all data that a merge reads from an archive: configuration,
 * origin, blocks, and whether the map is finished. It detects accidental changes, not
 * forgery.
 * \throws BadInputException if the file is no archive, or is damaged */
std::uint64_t archiveDigest(const std::string& path);

/** \brief Reads an archive, or all archives of a tile index, and verifies checksums and
 * counts.
 * \return one line per fault; empty if there are none
 * \throws BadInputException if it cannot be read, or is no archive */
std::vector<std::string> verifyArchive(const std::string& path,
                                       const BlockProgress& progress = nullptr);

} // namespace pcl_semantic
