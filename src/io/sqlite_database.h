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
 * Page 1 lies in FILE and, with another mark, in the log, where SQLite reads it. FILE's
 * we write ourselves; only another SQLite program brings the log's into FILE, with all
 * that is in the log. So FILE says whether a log that is not there was lost. */
struct FileMark {
  enum Kind : std::uint32_t {
    whole = 0x50434C53,   //!< "PCLS": there is no log
    old_log = 0x50434C57, //!< "PCLW": said by FILE and by the log of older archives
    logged = 0x51000000,  //!< said by the log, with a number: that of its last commit
    with_log = 0x52000000 //!< said by FILE, with that number
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
 * What SQLite reports becomes an exception that names the file: OutputException where
 * the disk or another program keeps a writer from its work, BadInputException where
 * the file cannot be used, std::bad_alloc where memory lacks. */
class SqliteDatabase {
public:
  enum class Access { read, write, create };

  /** \brief A log that is longer goes into the file; less in tests. [pages] */
  static inline int max_log = 1000;

  /** \throws BadInputException, OutputException */
  SqliteDatabase(const std::string& path, Access access);
  ~SqliteDatabase();
  SqliteDatabase(const SqliteDatabase&) = delete;
  SqliteDatabase& operator=(const SqliteDatabase&) = delete;

  /** \brief Runs statements that give nothing. */
  void run(const std::string& sql);

  /** \brief The mark that SQLite sees, be it the file's or the log's. */
  FileMark mark();

  /** \brief The statement that changes it. */
  static std::string markingAs(FileMark mark);

  /** \brief From now on commits go to FILE-wal first, so that readers are not in the
   * way; outside of a transaction.
   * \return false if another program was in the way */
  bool splitLog();

  /** \brief Ends a transaction after splitLog(); brings a long FILE-wal into the file
   * as far as readers allow. */
  void commit();

  /** \brief Brings FILE-wal into the file, outside of a transaction.
   * \return false if readers were in the way for two seconds: both then stay */
  bool joinLog();

  /** \brief Commits that FILE-wal had when the file was opened, or before, and that
   * SQLite does not find in it. */
  int
  lostCommits() const
  {
    return lost_commits_;
  }

  /** \brief The first number that a statement gives; 0 if it gives none. */
  std::int64_t number(const std::string& sql);

  const std::string&
  path() const
  {
    return path_;
  }

private:
  friend class SqliteStatement;

  /** \brief Throws what belongs to a result code of SQLite. */
  [[noreturn]] void throwError(int code) const;

  /** \brief As run(), but says whether a lock of another program was in the way. */
  bool runUnlessBusy(const std::string& sql);

  /** \brief Makes sure that FILE-wal is there if it belongs to FILE, and only then. */
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
  std::uint32_t commits_ = 0; // the number in marks
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

  /** \brief Runs it with numbers, texts or bytes as its parameters. */
  template <typename... Values>
  void
  run(const Values&... values)
  {
    forEachRow([] {}, values...);
  }

  /** \brief The same; \a visit may ask for the columns of the row it is called at. */
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
