// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

struct sqlite3;
struct sqlite3_io_methods;

namespace pcl_semantic {

/** \brief What page 1 of an archive says of its log, FILE-wal.
 *
 * Page 1 lies in FILE, and while there is a log in that, too: SQLite reads the log's.
 * The two never say the same: what FILE says we write there ourselves, and only another
 * SQLite program, or a run that ends, brings the log's into FILE. So FILE without a log
 * says whether one was lost. */
struct FileMark {
  static constexpr std::uint32_t whole = 0x50434C53; //!< "PCLS": there is no log

  /** \brief Said by the log: what it holds, FILE holds when it says so. */
  static std::uint32_t
  logged(std::uint16_t commits)
  {
    return 0x50470000 | commits; // "PG"
  }

  /** \brief Said by FILE: what was written last is in the log. */
  static std::uint32_t
  withLog(std::uint16_t commits)
  {
    return 0x504C0000 | commits; // "PL"
  }

  std::uint32_t version; //!< user_version: the format's, and a number of the log
  std::uint32_t mark;    //!< application_id: one of those above

  std::uint32_t
  format() const
  {
    return version & 0xFF;
  }

  bool
  isWhole() const
  {
    return mark == whole;
  }

  bool
  isLogged() const
  {
    return mark >> 16 == 0x5047;
  }

  bool
  isWithLog() const
  {
    return mark >> 16 == 0x504C;
  }

  /** \brief "PCLW", of older archives: FILE and the log say the same. */
  bool
  isWithOldLog() const
  {
    return mark == 0x50434C57;
  }

  bool
  isOurs() const
  {
    return isWhole() || isLogged() || isWithLog() || isWithOldLog();
  }

  /** \brief How many commits the log has had, modulo 2^16. */
  std::uint16_t
  commits() const
  {
    return std::uint16_t(isWhole() || isWithOldLog() ? 0 : mark);
  }
};

/** \brief The mark in FILE itself. It is read and written by SQLite's own handle:
 * closing another would drop the locks of this process. */
class MarkedFile {
public:
  /** \param[in] connection is closed before this ends */
  explicit MarkedFile(sqlite3* connection) : connection_(connection) {}

  /** \brief Zeros if it is too short to have one. */
  FileMark read() const;

  /** \param[in] is_flushed whether it is on the disk when this returns
   * \return a result code of SQLite */
  int write(std::uint32_t mark, bool is_flushed);

  /** \brief Whether SQLite, when it brings the log into FILE, leaves the mark alone. */
  void keep(bool keeps);

private:
  sqlite3* connection_;
  std::shared_ptr<const sqlite3_io_methods> keeping_; // null = it does not
};

} // namespace pcl_semantic
