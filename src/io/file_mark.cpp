// SPDX-License-Identifier: BSD-3-Clause
#include "file_mark.h"

#include "files/bytes.h"

#include <sqlite3.h>

namespace pcl_semantic {

namespace {

// In the header of a database, big-endian: https://www.sqlite.org/fileformat.html
constexpr int kVersionAt = 60, kMarkAt = 68, kMarkEnd = 72; // [bytes]

sqlite3_file*
fileOf(sqlite3* connection)
{
  sqlite3_file* file = nullptr;
  sqlite3_file_control(connection, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return file && file->pMethods ? file : nullptr;
}

int writeAroundMark(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 at);

// What SQLite calls to reach a file, but for one.
struct KeepingMethods : sqlite3_io_methods {
  explicit KeepingMethods(const sqlite3_io_methods& meant)
      : sqlite3_io_methods(meant), all(meant)
  {
    xWrite = writeAroundMark;
  }

  const sqlite3_io_methods& all;
};

// Page 1 is written but for the mark; all else as it is.
int
writeAroundMark(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 at)
{
  const auto& meant = static_cast<const KeepingMethods*>(file->pMethods)->all;
  if (at != 0 || size < kMarkEnd)
    return meant.xWrite(file, bytes, size, at);
  const int code = meant.xWrite(file, bytes, kMarkAt, 0);
  return code != SQLITE_OK
             ? code
             : meant.xWrite(file, static_cast<const char*>(bytes) + kMarkEnd,
                            size - kMarkEnd, kMarkEnd);
}

} // namespace

FileMark
MarkedFile::read() const
{
  std::uint8_t bytes[kMarkEnd - kVersionAt];
  sqlite3_file* const file = fileOf(connection_);
  if (!file ||
      file->pMethods->xRead(file, bytes, sizeof bytes, kVersionAt) != SQLITE_OK)
    return {};
  return {std::uint32_t(wholeNumber(bytes, 4)),
          std::uint32_t(wholeNumber(bytes + kMarkAt - kVersionAt, 4))};
}

int
MarkedFile::write(std::uint32_t mark, bool is_flushed)
{
  sqlite3_file* const file = fileOf(connection_);
  if (!file)
    return SQLITE_IOERR_WRITE;
  std::uint8_t bytes[kMarkEnd - kMarkAt];
  for (std::uint8_t& byte : bytes) {
    byte = std::uint8_t(mark >> 24);
    mark <<= 8;
  }
  const int code = file->pMethods->xWrite(file, bytes, sizeof bytes, kMarkAt);
  return code != SQLITE_OK || !is_flushed
             ? code
             : file->pMethods->xSync(file, SQLITE_SYNC_NORMAL);
}

void
MarkedFile::keep(bool keeps)
{
  sqlite3_file* const file = fileOf(connection_);
  if (!file || keeps == bool(keeping_))
    return;
  if (keeps) {
    const auto keeping = std::make_shared<const KeepingMethods>(*file->pMethods);
    keeping_ = keeping;
    file->pMethods = keeping_.get();
  }
  else {
    file->pMethods = &static_cast<const KeepingMethods&>(*keeping_).all;
    keeping_.reset();
  }
}

} // namespace pcl_semantic
