// SPDX-License-Identifier: BSD-3-Clause
#include "sqlite_database.h"

#include "core/fail.h"
#include "files/bytes.h"
#include "write_ahead_log.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>
#include <sqlite3.h>
#include <thread>
#include <utility>

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

// Bytes of FILE itself. Read by SQLite's own handle: closing another would drop the
// locks of this process. \return whether they are there
bool
readFile(sqlite3* connection, void* bytes, int size, std::int64_t at)
{
  sqlite3_file* file = nullptr;
  return sqlite3_file_control(connection, "main", SQLITE_FCNTL_FILE_POINTER, &file) ==
             SQLITE_OK &&
         file && file->pMethods &&
         file->pMethods->xRead(file, bytes, size, at) == SQLITE_OK;
}

// Whether a file is marked as belonging together with FILE-wal, in FILE itself.
bool
needsLog(sqlite3* connection)
{
  constexpr int at = 68; // application_id in the header of a database, big-endian
  unsigned char bytes[4] = {};
  if (!readFile(connection, bytes, sizeof bytes, at))
    return false;
  return wholeNumber(bytes, sizeof bytes) == SqliteDatabase::with_log;
}

// Whether a log holds what FILE has already, or its mark alone, as while somebody
// begins or ends to write.
bool
isInFile(sqlite3* connection, const WriteAheadLog& log)
{
  // Of the first page: kind of journal, counter of changes, mark, version.
  static constexpr std::pair<std::size_t, std::size_t> header[] = {
      {18, 20}, {24, 28}, {68, 72}, {92, 100}};
  for (const auto& [number, content] : log.pages()) {
    std::string page(content.size(), '\0'), logged(content);
    if (!readFile(connection, page.data(), int(page.size()),
                  std::int64_t(number - 1) * std::int64_t(page.size())))
      return false;
    if (number == 1)
      for (const auto& [begin, end] : header)
        logged.replace(begin, end - begin, page, begin, end - begin);
    if (page != logged)
      return false;
  }
  return true;
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
    requireLog();
    // FILE-wal goes with the last connection otherwise, and nobody can tell any more
    // whether it was lost.
    sqlite3_db_config(connection_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    sqlite3_busy_timeout(connection_,
                         access == Access::read ? kReaderPatience : kWriterPatience);
    sqlite3_limit(connection_, SQLITE_LIMIT_LENGTH, kMaxRow);
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

void
SqliteDatabase::requireLog() const
{
  const std::string log = path_ + "-wal";
  // Another program may have been beginning or ending to write.
  for (int attempt = 0;; ++attempt) {
    std::error_code error;
    const bool has_log = std::filesystem::exists(log, error);
    const bool needs_log = needsLog(connection_);
    if (needs_log ? has_log : !has_log || isInFile(connection_, WriteAheadLog(log)))
      return;
    if (attempt == 4 && needs_log)
      badInput(path_, ": lacks ", log,
               ", which holds what was written last: copy both (if it is lost, "
               "an empty file of that name lets the rest be read)");
    if (attempt == 4)
      badInput(path_, ": is whole, but beside it lies ", log,
               " of another archive, which would change it: remove that");
    waitALittle();
  }
}

std::string
SqliteDatabase::markingAs(FileMark mark)
{
  return "PRAGMA application_id = " + std::to_string(mark);
}

bool
SqliteDatabase::moveLogToFile()
{
  return number("PRAGMA wal_checkpoint(FULL)") == 0; // 1: a reader was in the way
}

bool
SqliteDatabase::splitLog()
{
  if (!runUnlessBusy("PRAGMA journal_mode = WAL"))
    return false;
  run(markingAs(with_log));
  return needsLog(connection_) || moveLogToFile();
}

bool
SqliteDatabase::joinLog()
{
  sqlite3_busy_timeout(connection_, 0);
  // A reader is done soon, as a rule.
  for (int attempt = 0; attempt < 40; ++attempt) {
    // Everything else is in the file before the mark that says so.
    if (moveLogToFile() && runUnlessBusy(markingAs(whole)) && moveLogToFile() &&
        runUnlessBusy("PRAGMA journal_mode = DELETE"))
      return true;
    waitALittle();
  }
  return false;
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
