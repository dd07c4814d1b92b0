// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"
#include "files/bytes.h"
#include "sqlite_database.h"

#include <pcl_semantic/core/voxel_index.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace pcl_semantic {

/** \brief The tables of a map archive: sealed values under a name, a frame number or a
 * block index. Every value holds its own key, which reading compares, so that neither a
 * value nor the place it lies at can change unnoticed.
 *
 * Writers have the file to themselves from beginning to end; readers see it as it was
 * last committed. Everything throws as SqliteDatabase does, with the key in the
 * message. */
class ArchiveDatabase {
public:
  using Access = SqliteDatabase::Access;

  /** \brief Makes an empty archive, and only with all its tables in the place.
   * \param[in] fill puts values into it
   * \throws OutputException also if there is one already */
  static void create(const std::string& path,
                     const std::function<void(ArchiveDatabase&)>& fill);

  ArchiveDatabase(const std::string& path, Access access);
  ~ArchiveDatabase();

  /** \brief Ends the transaction, and begins the next. */
  void commit();

  /** \brief Drops what was not committed; brings all into one file.
   * \return false if readers were in the way: FILE-wal then still belongs to it */
  bool close();

  void putMeta(const std::string& name, const Bytes& content);

  /** \brief Calls \a decode with what was put. */
  void getMeta(const std::string& name,
               const std::function<void(const Bytes&)>& decode);

  void putFrame(int number, const Bytes& content);
  void forEachFrame(const std::function<void(int, const Bytes&)>& visit);
  std::uint64_t countFrames();

  /** \brief The largest number of a frame; -1 without any. */
  std::int64_t lastFrame();

  /** \param[in] sealed an encoded block, which begins with its index */
  void putBlock(const VoxelIndex& index, const Bytes& sealed);

  /** \brief A stored block; nothing if there is no such block. */
  std::optional<std::string> getBlock(const VoxelIndex& index);

  /** \brief Visits the keys of the blocks in the order z, y, x. */
  void forEachBlockKey(const std::function<void(const VoxelIndex&)>& visit);

  /** \brief Visits the blocks in that order, each with what was put. */
  void
  forEachBlock(const std::function<void(const VoxelIndex&, std::string_view)>& visit);

  /** \brief Decodes a sealed block. */
  Bytes unsealBlock(const VoxelIndex& index, std::string_view sealed) const;

  /** \brief Faults of the file that SQLite finds, and faults of its log, a line each.
   */
  std::vector<std::string> integrityFaults();

  const std::string&
  path() const
  {
    return database_.path();
  }

private:
  struct Statements;

  explicit ArchiveDatabase(const std::string& path);

  void checkTables();
  VoxelIndex keyOf(const SqliteStatement& row) const;

  SqliteDatabase database_;
  std::unique_ptr<Statements> statements_;
};

/** \brief Makes an archive that appears under its name whole or not at all.
 * \param[in] make makes a file of the name that it is given
 * \throws OutputException if there is one already, or remains of one, which SQLite
 * would take for a part of the new one; of what \a make throws, the name is put right
 */
void makeArchiveFile(const std::string& path,
                     const std::function<void(const std::string&)>& make);

/** \brief Text of a key for messages: "block 1 -2 3" (x y z). */
std::string nameOfBlock(const VoxelIndex& index);

/** \brief Runs \a read, and puts \a where in front of what it finds wrong. */
template <typename Read>
auto
readAt(const std::string& where, Read&& read)
{
  try {
    return read();
  }
  catch (const BadInputException& error) {
    badInput(where, ": ", error.what());
  }
}

} // namespace pcl_semantic
