// SPDX-License-Identifier: BSD-3-Clause
#include "sqlite_database.h"

#include "core/fail.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>
#include <sqlite3.h>
#include <thread>

namespace pcl_semantic {

namespace {

// No row of ours is larger; a damaged file may claim so.
constexpr int kMaxRow = 1 << 25;

// A reader may have to wait until a writer has found its feet; a second writer is
// refused at once.
constexpr int kReaderPatience = 5000; // [ms]
constexpr int kWriterPatience = 100;  // [ms]

// What keeps a writer from writing, not what is wrong with the file.
bool
isOutputFailure(int code)
{
  const auto isOneOf = [](int kind, std::initializer_list<int> kinds) {
    return std::count(kinds.begin(), kinds.end(), kind) > 0;
  };
  return isOneOf(code & 0xFF, {SQLITE_FULL, SQLITE_IOERR, SQLITE_READONLY,
                               SQLITE_CANTOPEN, SQLITE_PERM, SQLITE_PROTOCOL}) &&
         !isOneOf(code,
                  {SQLITE_IOERR_READ, SQLITE_IOERR_SHORT_READ, SQLITE_IOERR_CORRUPTFS});
}

// The number of a format, with that of a log; 0 = there is none.
std::string
settingVersion(std::uint32_t version, std::uint32_t log)
{
  return "PRAGMA user_version = " + std::to_string(version | (log & 0x7FFFFF) << 8);
}

// For somebody else to come to an end of what takes no time.
void
waitALittle()
{
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

} // namespace

SqliteDatabase::SqliteDatabase(const std::string& path, Access access)
    : path_(path), access_(access)
{
  // A reader, too, undoes what a killed writer left half done, where it may.
  const int flags = SQLITE_OPEN_READWRITE |
                    (access == Access::create ? SQLITE_OPEN_CREATE : 0) |
                    SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  // Some relative names (":memory:") mean something else to SQLite.
  const std::string absolute = std::filesystem::absolute(path).string();
  const int code = sqlite3_open_v2(absolute.c_str(), &connection_, flags, nullptr);
  try {
    if (code != SQLITE_OK)
      throwError(code);
    file_ = MarkedFile(connection_);
    // FILE-wal goes with the last connection otherwise, and nobody can tell any more
    // whether it was lost.
    sqlite3_db_config(connection_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    sqlite3_busy_timeout(connection_,
                         access == Access::read ? kReaderPatience : kWriterPatience);
    sqlite3_limit(connection_, SQLITE_LIMIT_LENGTH, kMaxRow);
    requireOwnLog();
    // SQLite opens what it may not write without a word.
    if (access != Access::read && sqlite3_db_readonly(connection_, "main") == 1)
      throwError(SQLITE_READONLY);
    run("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON");
    if (access == Access::read)
      run("PRAGMA query_only = ON");
  }
  catch (...) {
    sqlite3_close(connection_);
    throw;
  }
}

SqliteDatabase::~SqliteDatabase()
{
  sqlite3_close(connection_);
}

void
SqliteDatabase::run(const std::string& sql)
{
  if (!runUnlessBusy(sql))
    throwError(SQLITE_BUSY);
}

bool
SqliteDatabase::runUnlessBusy(const std::string& sql)
{
  const int code = sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK && (code & 0xFF) != SQLITE_BUSY)
    throwError(code);
  return code == SQLITE_OK;
}

FileMark
SqliteDatabase::mark()
{
  return {std::uint32_t(number("PRAGMA user_version")),
          std::uint32_t(number("PRAGMA application_id"))};
}

void
SqliteDatabase::requireOwnLog()
{
  // Another program may have been beginning or ending to write.
  for (int attempt = 0;; ++attempt) {
    const std::string fault = faultOfLog(path_ + "-wal");
    if (fault.empty())
      return;
    if (attempt == 4)
      badInput(path_, ": ", fault);
    waitALittle();
  }
}

// Reads no log itself: SQLite does, and what it finds is compared with what FILE says.
std::string
SqliteDatabase::faultOfLog(const std::string& log)
{
  static const char* const remedy =
      " (if it is lost, an empty file of that name lets the rest be read)";
  std::error_code error;
  const FileMark file = file_.read(); // first: what SQLite sees is as new, or newer
  const bool has_log = std::filesystem::exists(log, error);
  // First: SQLite makes a new one.
  if ((file.isWithLog() || file.isWithOldLog()) && !has_log)
    return "lacks " + log + ", which holds what was written last: copy both" + remedy;
  const FileMark seen = mark();
  if (!file.isOurs() || !has_log)
    return "";
  if (file.isWhole() && !seen.isWhole())
    return "is whole, but beside it lies " + log +
           " of another archive, which would change it: remove that";
  if (file.version != seen.version)
    return "has beside it " + log + " of another archive, and not its own: copy both" +
           remedy;
  if (file.isWithLog() && seen.isWithLog() &&
      std::filesystem::file_size(log, error) > 0)
    return log + " is damaged: nothing is found in it" + remedy;
  if (file.isWithLog() && seen.isLogged())
    lost_commits_ =
        std::max<int>(0, std::int16_t(std::uint16_t(file.commits() - seen.commits())));
  return "";
}

std::string
SqliteDatabase::markingAs(std::uint32_t mark)
{
  return "PRAGMA application_id = " + std::to_string(mark);
}

void
SqliteDatabase::write(std::uint32_t mark, bool is_flushed)
{
  if (const int code = file_.write(mark, is_flushed))
    throwError(code);
}

bool
SqliteDatabase::moveLogToFile()
{
  return number("PRAGMA wal_checkpoint(FULL)") == 0; // 1: a reader was in the way
}

bool
SqliteDatabase::splitLog()
{
  const FileMark seen = mark();
  commits_ = seen.commits();
  if (seen.isWhole()) {
    std::uint32_t id = 0;
    sqlite3_randomness(sizeof id, &id);
    // Not yet withLog(): there is no log that could be lacking.
    if (!runUnlessBusy("PRAGMA journal_mode = DELETE") ||
        !runUnlessBusy(settingVersion(seen.format(), id)) ||
        !runUnlessBusy(markingAs(FileMark::logged(commits_))))
      return false;
  }
  if (!runUnlessBusy("PRAGMA journal_mode = WAL"))
    return false;
  sqlite3_wal_hook(
      connection_,
      [](void* pages, sqlite3*, const char*, int count) {
        *static_cast<int*>(pages) = count;
        return SQLITE_OK;
      },
      &log_pages_);
  file_.keep(true);
  // The log, with its mark, is on the disk before FILE says so.
  run(markingAs(FileMark::logged(commits_)));
  write(FileMark::withLog(commits_), true);
  return true;
}

void
SqliteDatabase::commit()
{
  run(markingAs(FileMark::logged(std::uint16_t(commits_ + 1))) + "; COMMIT");
  ++commits_;
  // Also if another program has brought the log's mark into FILE.
  write(FileMark::withLog(commits_), false);
  if (log_pages_ >= max_log)
    renewLog();
}

void
SqliteDatabase::renewLog()
{
  int pages = 0, moved = 0;
  if (sqlite3_wal_checkpoint_v2(connection_, "main", SQLITE_CHECKPOINT_PASSIVE, &pages,
                                &moved) != SQLITE_OK ||
      pages != moved)
    return; // it is tried again after the next commit
  // SQLite now begins the log anew. Until our mark is in it nothing is lacking in FILE.
  write(FileMark::logged(commits_), true);
  run(markingAs(FileMark::logged(commits_)));
  write(FileMark::withLog(commits_), true);
}

bool
SqliteDatabase::joinLog()
{
  sqlite3_busy_timeout(connection_, 0);
  // A reader is done soon, as a rule.
  for (int attempt = 0; attempt < 40; ++attempt) {
    if (moveLogToFile()) {
      write(FileMark::logged(commits_), true);
      std::error_code error;
      // SQLite does not say whether the disk let it remove the log.
      if (runUnlessBusy("PRAGMA journal_mode = DELETE") &&
          !std::filesystem::exists(path_ + "-wal", error)) {
        markAsWhole();
        return true;
      }
    }
    waitALittle();
  }
  return false;
}

// What a reader that has just come may prevent: the file has everything all the same.
void
SqliteDatabase::markAsWhole()
{
  file_.keep(false);
  sqlite3_busy_timeout(connection_, kWriterPatience);
  runUnlessBusy(settingVersion(mark().format(), 0) + "; " + markingAs(FileMark::whole));
}

std::int64_t
SqliteDatabase::number(const std::string& sql)
{
  SqliteStatement statement(*this, sql);
  std::int64_t result = 0;
  statement.forEachRow([&] { result = statement.integer(0); });
  return result;
}

void
SqliteDatabase::throwError(int code) const
{
  const int kind = code & 0xFF;
  if (kind == SQLITE_NOMEM)
    throw std::bad_alloc();
  if (kind == SQLITE_BUSY || kind == SQLITE_LOCKED) {
    if (access_ == Access::read)
      badInput(path_, ": cannot be read: another program has locked it");
    fail<OutputException>(path_, ": another program is writing it");
  }
  const char* const why = sqlite3_errstr(code);
  if (access_ != Access::read && isOutputFailure(code))
    fail<OutputException>(path_, ": cannot be written: ", why,
                          (kind == SQLITE_IOERR ? " (is the disk full?)" : ""));
  if (kind == SQLITE_CANTOPEN || kind == SQLITE_READONLY || kind == SQLITE_PERM)
    badInput(path_, ": cannot be read: ", why,
             " (what a killed run left needs a folder that can be written)");
  if (kind == SQLITE_NOTADB)
    badInput(path_, ": is no map archive: ", why);
  badInput(path_, ": is damaged: ", why);
}

SqliteStatement::SqliteStatement(SqliteDatabase& database, const std::string& sql)
    : database_(database)
{
  const int code =
      sqlite3_prepare_v3(database_.connection_, sql.c_str(), int(sql.size()) + 1,
                         SQLITE_PREPARE_PERSISTENT, &statement_, nullptr);
  if (code != SQLITE_OK)
    database_.throwError(code);
}

SqliteStatement::~SqliteStatement()
{
  sqlite3_finalize(statement_);
}

SqliteStatement::Reset::~Reset()
{
  sqlite3_reset(statement.statement_);
}

void
SqliteStatement::bind(int parameter, std::int64_t value)
{
  if (const int code = sqlite3_bind_int64(statement_, parameter, value))
    database_.throwError(code);
}

void
SqliteStatement::bind(int parameter, const std::string& text)
{
  if (const int code = sqlite3_bind_text(statement_, parameter, text.data(),
                                         int(text.size()), SQLITE_STATIC))
    database_.throwError(code);
}

void
SqliteStatement::bind(int parameter, const std::vector<std::uint8_t>& bytes)
{
  if (const int code = sqlite3_bind_blob64(statement_, parameter, bytes.data(),
                                           bytes.size(), SQLITE_STATIC))
    database_.throwError(code);
}

bool
SqliteStatement::step()
{
  const int code = sqlite3_step(statement_);
  if (code != SQLITE_ROW && code != SQLITE_DONE)
    database_.throwError(code);
  return code == SQLITE_ROW;
}

std::int64_t
SqliteStatement::integer(int column) const
{
  return sqlite3_column_int64(statement_, column);
}

std::string_view
SqliteStatement::bytes(int column) const
{
  const auto* const data =
      static_cast<const char*>(sqlite3_column_blob(statement_, column));
  if (!data)
    return {};
  return {data, std::size_t(sqlite3_column_bytes(statement_, column))};
}

} // namespace pcl_semantic
