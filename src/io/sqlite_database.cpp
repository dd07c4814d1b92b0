// SPDX-License-Identifier: BSD-3-Clause
#include "sqlite_database.h"

#include "core/fail.h"
#include "files/bytes.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <sqlite3.h>
#include <thread>

namespace pcl_semantic {

namespace {

// Larger than any row of an archive; a damaged file may claim more.
constexpr int kMaxRow = 1 << 25;

// A reader waits until a starting writer is ready; a second writer is refused soon.
constexpr int kReaderPatience = 5000; // [ms]
constexpr int kWriterPatience = 100;  // [ms]

// Whether a code means that writing is impossible, not that the file is bad.
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

// Position of the mark, big-endian: https://www.sqlite.org/fileformat.html
constexpr int kMarkAt = 68, kMarkEnd = 72; // [bytes]

sqlite3_file&
fileOf(sqlite3* connection)
{
  sqlite3_file* file = nullptr;
  sqlite3_file_control(connection, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return *file;
}

// SQLite's file methods, except for writing.
struct KeepingMethods : sqlite3_io_methods {
  explicit KeepingMethods(const sqlite3_io_methods& usual)
      : sqlite3_io_methods(usual), usual_write(usual.xWrite)
  {
    xWrite = writeAroundMark;
  }

  static int
  writeAroundMark(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 at)
  {
    const auto& methods = static_cast<const KeepingMethods&>(*file->pMethods);
    if (at != 0 || size < kMarkEnd)
      return methods.usual_write(file, bytes, size, at);
    const int code = methods.usual_write(file, bytes, kMarkAt, 0);
    return code != SQLITE_OK
               ? code
               : methods.usual_write(file, static_cast<const char*>(bytes) + kMarkEnd,
                                     size - kMarkEnd, kMarkEnd);
  }

  decltype(xWrite) usual_write;
};

// The mark in FILE, read by SQLite's own handle: closing another descriptor would drop
// the locks of this process. \return 0 if the file is too short
FileMark
readMark(sqlite3* connection)
{
  std::uint8_t bytes[kMarkEnd - kMarkAt];
  sqlite3_file& file = fileOf(connection);
  const int code = file.pMethods->xRead(&file, bytes, sizeof bytes, kMarkAt);
  return {code == SQLITE_OK ? std::uint32_t(wholeNumber(bytes, sizeof bytes)) : 0};
}

// \return a result code of SQLite
int
writeMark(sqlite3* connection, FileMark mark, bool is_flushed)
{
  std::uint8_t bytes[kMarkEnd - kMarkAt];
  for (int i = 0; i < 4; ++i)
    bytes[i] = std::uint8_t(mark.value >> (24 - 8 * i));
  sqlite3_file& file = fileOf(connection);
  const int code = file.pMethods->xWrite(&file, bytes, sizeof bytes, kMarkAt);
  return code == SQLITE_OK && is_flushed
             ? file.pMethods->xSync(&file, SQLITE_SYNC_NORMAL)
             : code;
}

// Makes SQLite preserve the mark in FILE when it writes page 1. \return an object that
// must live as long as the connection
std::shared_ptr<const sqlite3_io_methods>
keepMark(sqlite3* connection)
{
  sqlite3_file& file = fileOf(connection);
  auto keeping = std::make_shared<const KeepingMethods>(*file.pMethods);
  file.pMethods = keeping.get();
  return keeping;
}

void
waitALittle()
{
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

} // namespace

SqliteDatabase::SqliteDatabase(const std::string& path, Access access)
    : path_(path), access_(access)
{
  // Readers also roll back an unfinished transaction of a killed writer, if permitted.
  const int flags = SQLITE_OPEN_READWRITE |
                    (access == Access::create ? SQLITE_OPEN_CREATE : 0) |
                    SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  // Some relative names (":memory:") are special in SQLite.
  const std::string absolute = std::filesystem::absolute(path).string();
  const int code = sqlite3_open_v2(absolute.c_str(), &connection_, flags, nullptr);
  try {
    if (code != SQLITE_OK)
      throwError(code);
    // Otherwise closing the last connection removes FILE-wal, and a lost log could no
    // longer be detected.
    sqlite3_db_config(connection_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    sqlite3_busy_timeout(connection_,
                         access == Access::read ? kReaderPatience : kWriterPatience);
    sqlite3_limit(connection_, SQLITE_LIMIT_LENGTH, kMaxRow);
    requireOwnLog();
    // SQLite silently opens a write-protected file as read-only.
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
  return {std::uint32_t(number("PRAGMA application_id"))};
}

void
SqliteDatabase::requireOwnLog()
{
  // Another program may be starting or stopping to write.
  for (int attempt = 0;; ++attempt) {
    const std::string fault = faultOfLog(path_ + "-wal");
    if (fault.empty())
      return;
    if (attempt == 4)
      badInput(path_, ": ", fault);
    waitALittle();
  }
}

// SQLite reads the log; its mark is compared with that of FILE.
std::string
SqliteDatabase::faultOfLog(const std::string& log)
{
  static const char* const remedy =
      " (if it is lost, create an empty file of that name to read the rest)";
  constexpr int most = 1000; // in one log; FILE is older if it was copied first
  std::error_code error;
  const FileMark file = readMark(connection_); // first: another program may commit
                                               // meanwhile
  const bool has_log = std::filesystem::exists(log, error); // first: SQLite creates one
  if ((file.is(FileMark::with_log) || file.is(FileMark::old_log)) && !has_log)
    return "lacks " + log + ", which holds the last commits; copy both" + remedy;
  const FileMark seen = mark();
  if (file.is(FileMark::whole) && !seen.is(FileMark::whole))
    return "is complete, but " + log +
           " is of another archive and would change it; remove that";
  if (!file.is(FileMark::with_log) && !file.is(FileMark::logged))
    return "";
  if (file.is(FileMark::with_log) && seen.is(FileMark::with_log) &&
      std::filesystem::file_size(log, error) > 0)
    return log + " is damaged: it has no commit" + remedy;
  const int behind = std::int32_t((file.value - seen.value) << 8) >> 8; // difference of
                                                                        // 24-bit
                                                                        // counters
  if (std::abs(behind) > most || seen.is(FileMark::old_log))
    return "got " + log + " of another archive, expected its own; copy both" + remedy;
  lost_commits_ = std::max(0, behind);
  return "";
}

std::string
SqliteDatabase::markingAs(FileMark mark)
{
  return "PRAGMA application_id = " + std::to_string(mark.value);
}

FileMark
SqliteDatabase::markOf(FileMark::Kind kind) const
{
  return {kind | (commits_ & 0xFFFFFF)};
}

void
SqliteDatabase::write(FileMark::Kind kind, bool is_flushed)
{
  if (const int code = writeMark(connection_, markOf(kind), is_flushed))
    throwError(code);
}

bool
SqliteDatabase::moveLogToFile()
{
  int pages = 0, moved = 0;
  const int code = sqlite3_wal_checkpoint_v2(connection_, "main",
                                             SQLITE_CHECKPOINT_PASSIVE, &pages, &moved);
  if (code != SQLITE_OK && (code & 0xFF) != SQLITE_BUSY)
    throwError(code);
  return code == SQLITE_OK && pages == moved;
}

bool
SqliteDatabase::splitLog()
{
  const FileMark seen = mark();
  if (seen.is(FileMark::whole) || seen.is(FileMark::old_log))
    sqlite3_randomness(sizeof commits_, &commits_); // random, unlike that of any other
                                                    // log
  else
    commits_ = seen.value;
  // Not yet with_log, because no log exists that could be missing.
  if ((seen.is(FileMark::whole) &&
       !(runUnlessBusy("PRAGMA journal_mode = DELETE") &&
         runUnlessBusy(markingAs(markOf(FileMark::logged))))) ||
      !runUnlessBusy("PRAGMA journal_mode = WAL"))
    return false;
  sqlite3_wal_hook(
      connection_,
      [](void* pages, sqlite3*, const char*, int count) {
        *static_cast<int*>(pages) = count;
        return SQLITE_OK;
      },
      &log_pages_);
  keeping_mark_ = keepMark(connection_);
  beginLog();
  return true;
}

// Flushes the log's mark before FILE states that there is a log.
void
SqliteDatabase::beginLog()
{
  run(markingAs(markOf(FileMark::logged)));
  write(FileMark::with_log, true);
}

void
SqliteDatabase::commit()
{
  ++commits_;
  run(markingAs(markOf(FileMark::logged)) + "; COMMIT");
  // Also if another program has moved the log's mark into FILE.
  write(FileMark::with_log, false);
  if (log_pages_ < max_log || !moveLogToFile())
    return;
  // SQLite restarts the log. Until it contains our mark, FILE is complete.
  write(FileMark::logged, true);
  beginLog();
}

bool
SqliteDatabase::joinLog()
{
  sqlite3_busy_timeout(connection_, 0);
  std::error_code error;
  // Readers usually finish soon.
  for (int attempt = 0; attempt < 40; ++attempt, waitALittle()) {
    if (!moveLogToFile())
      continue;
    write(FileMark::logged, true);
    // SQLite does not report whether it could remove the log.
    if (!runUnlessBusy("PRAGMA journal_mode = DELETE") ||
        std::filesystem::exists(path_ + "-wal", error))
      continue;
    // If a new reader prevents the last mark, FILE is complete anyway.
    if (runUnlessBusy(markingAs({FileMark::whole})))
      if (const int code = writeMark(connection_, {FileMark::whole}, true))
        throwError(code);
    return true;
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
             " (the archive of a killed run needs a writable folder)");
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
