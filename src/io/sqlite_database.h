// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_io_methods;
struct sqlite3_stmt;

namespace pcl_semantic {

/** \brief State of an archive's log, FILE-wal, from the application_id in page 1.
 *
 * Page 1 is in FILE and, with another mark, in the log, where SQLite reads it. This
 * library writes the mark in FILE. Only another SQLite program would move the log's
 * mark into FILE, together with the whole log. Therefore FILE tells whether a missing
 * log was lost. */
struct FileMark {
  enum Kind : std::uint32_t {
    whole = 0x50434C53,   //!< "PCLS": there is no log
    old_log = 0x50434C57, //!< "PCLW": in FILE and log of older archives
    logged = 0x51000000,  //!< in the log, plus the number of its last commit
    with_log = 0x52000000 //!< in FILE, plus the same number
  };

  std::uint32_t value = 0;

  bool
  is(Kind kind) const
  {
    return value == kind || (value & 0xFF000000) == kind;
  }
};

/** \brief A connection to an SQLite file; for one thread at a time.
 *
 * SQLite's errors become exceptions with the file name: OutputException if the disk or
 * another program prevents writing, BadInputException if the file cannot be used,
 * std::bad_alloc if memory is exhausted. */
class SqliteDatabase {
public:
  enum class Access { read, write, create };

  /** \brief A longer log is moved into the file; smaller in tests. [pages] */
  static inline int max_log = 1000;

  /** \throws BadInputException, OutputException */
  SqliteDatabase(const std::string& path, Access access);
  ~SqliteDatabase();
  SqliteDatabase(const SqliteDatabase&) = delete;
  SqliteDatabase& operator=(const SqliteDatabase&) = delete;

  /** \brief Runs statements without result. */
  void run(const std::string& sql);

  /** \brief The mark that SQLite reads, from the file or the log. */
  FileMark mark();

  /** \brief The statement that sets the mark. */
  static std::string markingAs(FileMark mark);

  /** \brief Makes commits go to FILE-wal first, so that readers do not block them; call
   * it outside of a transaction.
   * \return false if another program prevented it */
  bool splitLog();

  /** \brief Commits a transaction after splitLog(); moves a long FILE-wal into the file
   * as far as readers allow. */
  void commit();

  /** \brief Moves FILE-wal into the file; call it outside of a transaction.
   * \return false if readers prevented it for two seconds: both files then stay */
  bool joinLog();

  /** \brief Number of commits that were in FILE-wal when the file was opened or before,
   * and that SQLite no longer finds. */
  int
  lostCommits() const
  {
    return lost_commits_;
  }

  /** \brief The first number of a statement's result; 0 if it is empty. */
  std::int64_t number(const std::string& sql);

  const std::string&
  path() const
  {
    return path_;
  }

private:
  friend class SqliteStatement;

  /** \brief Throws the exception for a result code of SQLite. */
  [[noreturn]] void throwError(int code) const;

  /** \brief As run(); returns false if a lock of another program prevented it. */
  bool runUnlessBusy(const std::string& sql);

  /** \brief Requires that FILE-wal exists if and only if it belongs to FILE. */
  void requireOwnLog();
  std::string faultOfLog(const std::string& log);

  void write(FileMark::Kind kind, bool is_flushed);
  void beginLog();
  bool moveLogToFile();
  FileMark markOf(FileMark::Kind kind) const;

  std::string path_;
  Access access_;
  sqlite3* connection_ = nullptr;
  std::shared_ptr<const sqlite3_io_methods> keeping_mark_;
  std::uint32_t commits_ = 0; // number in marks
  int lost_commits_ = 0;
  int log_pages_ = 0; // after the last commit
};

/** \brief A prepared statement; parameters count from 1, columns from 0. */
class SqliteStatement {
public:
  SqliteStatement(SqliteDatabase& database, const std::string& sql);
  ~SqliteStatement();
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  /** \brief Runs the statement with numbers, texts or bytes as parameters. */
  template <typename... Values>
  void
  run(const Values&... values)
  {
    forEachRow([] {}, values...);
  }

  /** \brief Does the same; \a visit may read the columns of the current row. */
  template <typename Visit, typename... Values>
  void
  forEachRow(Visit&& visit, const Values&... values)
  {
    const Reset at_the_end{*this};
    int parameter = 0;
    (bind(++parameter, values), ...);
    while (step())
      visit();
  }

  std::int64_t integer(int column) const;

  /** \brief Valid until the next row. */
  std::string_view bytes(int column) const;

private:
  struct Reset {
    ~Reset();
    SqliteStatement& statement;
  };

  void bind(int parameter, std::int64_t value);
  void bind(int parameter, const std::string& text);
  void bind(int parameter, const std::vector<std::uint8_t>& bytes);
  bool step();

  SqliteDatabase& database_;
  sqlite3_stmt* statement_ = nullptr;
};

} // namespace pcl_semantic
