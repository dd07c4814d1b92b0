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

/** \brief The tables of a map archive: sealed values by name, frame number or block
 * index. Every value contains its own key, which is verified on reading, so that damage
 * to values and exchanged rows are detected.
 *
 * A writer has exclusive access; readers see the last commit. Everything throws as
 * SqliteDatabase does, with the key in the message. */
class ArchiveDatabase {
public:
  using Access = SqliteDatabase::Access;

  /** \brief Makes an empty archive, which appears only when all its tables are
   * complete.
   * \param[in] fill adds values to it
   * \throws OutputException also if the file exists */
  static void create(const std::string& path,
                     const std::function<void(ArchiveDatabase&)>& fill);

  ArchiveDatabase(const std::string& path, Access access);
  ~ArchiveDatabase();

  /** \brief Ends the transaction and begins the next one. */
  void commit();

  /** \brief Discards uncommitted changes and moves the log into the file.
   * \return false if readers prevented it: FILE-wal then still belongs to the file */
  bool close();

  void putMeta(const std::string& name, const Bytes& content);

  /** \brief Calls \a decode with a stored value. */
  void getMeta(const std::string& name,
               const std::function<void(const Bytes&)>& decode);

  bool hasMeta(const std::string& name);

  void eraseMeta(const std::string& name);

  /** \brief Number of values whose names begin with a text, without % and _. */
  std::uint64_t countMeta(const std::string& begin);

  void putFrame(int number, const Bytes& content);
  void forEachFrame(const std::function<void(int, const Bytes&)>& visit);
  std::uint64_t countFrames();

  /** \brief The largest frame number; -1 if there are no frames. */
  std::int64_t lastFrame();

  /** \param[in] sealed an encoded block, which begins with its index */
  void putBlock(const VoxelIndex& index, const Bytes& sealed);

  /** \brief A stored block, sealed; nothing if there is none. */
  std::optional<std::string> getBlock(const VoxelIndex& index);

  /** \brief Visits the keys of the blocks in the order z, y, x. */
  void forEachBlockKey(const std::function<void(const VoxelIndex&)>& visit);

  /** \brief Visits the sealed blocks in the order z, y, x. */
  void
  forEachBlock(const std::function<void(const VoxelIndex&, std::string_view)>& visit);

  Bytes unsealBlock(const VoxelIndex& index, std::string_view sealed) const;

  /** \brief Faults of the file and its log that SQLite finds, one per line. */
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

/** \brief Makes an archive that appears under its name complete or not at all.
 * \param[in] make makes a file with the given name
 * \throws OutputException if the file exists, or remains of one, which SQLite would
 * treat as part of the new one; in exceptions of \a make the file name is replaced by
 * \a path */
void makeArchiveFile(const std::string& path,
                     const std::function<void(const std::string&)>& make);

/** \brief Text of a key for messages: "block 1 -2 3" (x y z). */
std::string nameOfBlock(const VoxelIndex& index);

/** \brief Runs \a read and prepends \a where to its error messages. */
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
