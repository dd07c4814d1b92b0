// SPDX-License-Identifier: BSD-3-Clause
#include "archive_database.h"
#include "block_encoding.h"
#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>

#include <fcntl.h>
#include <unistd.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kVersion = 3;       // 3: deviations of labels
constexpr std::int64_t kOldestVersion = 2; // 2: positions of hits

constexpr std::size_t kMaxMeta = 1 << 26; // an object of 4 million voxels
constexpr std::size_t kMaxFrame = 1 << 16;
constexpr std::size_t kMaxBlock = 1 << 21; // 512 records of 255 classes: 1.1 MB

const std::vector<std::string> tables = {
    "CREATE TABLE blocks(id INTEGER PRIMARY KEY, z INTEGER NOT NULL, y INTEGER NOT "
    "NULL, x INTEGER NOT NULL, content BLOB NOT NULL, UNIQUE(z, y, x)) STRICT",
    "CREATE TABLE frames(number INTEGER PRIMARY KEY, value BLOB NOT NULL) STRICT",
    "CREATE TABLE meta(name TEXT PRIMARY KEY, value BLOB NOT NULL) STRICT, WITHOUT "
    "ROWID"};

Bytes
unseal(std::string_view sealed, std::size_t max_size)
{
  return pcl_semantic::unseal(sealed.data(), sealed.size(), max_size);
}

void
requireReadableFile(const std::string& path)
{
  requireRegularFile(path);
  // access() instead of opening: closing another descriptor would drop SQLite's locks
  // of this process.
  if (::access(path.c_str(), R_OK) != 0)
    badInput(path, ": cannot be read: ", std::strerror(errno));
}

void
refuseExisting(const std::string& path)
{
  std::error_code error;
  if (fs::exists(path, error))
    fail<OutputException>(path, ": is there already");
  for (const char* const ending : {"-wal", "-journal"})
    if (fs::exists(path + ending, error))
      fail<OutputException>(path + ending,
                            ": belongs to an earlier archive of that name; remove it");
}

// Never replaces a file that another process created meanwhile, where the file system
// supports this.
void
rename(const std::string& from, const std::string& to)
{
  int result =
      ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE);
  if (result != 0 && (errno == EINVAL || errno == ENOSYS)) {
    refuseExisting(to);
    result = ::rename(from.c_str(), to.c_str());
  }
  if (result != 0)
    fail<OutputException>(to, ": cannot be written: ", std::strerror(errno));
}

// Removes a file that was not renamed.
struct Temporary {
  explicit Temporary(const fs::path& path)
      : name(path.parent_path() / ("." + path.filename().string() + "." +
                                   std::to_string(::getpid()) + ".tmp"))
  {
    remove();
  }

  ~Temporary()
  {
    try {
      remove();
    }
    catch (const std::bad_alloc&) { // leave the file
    }
  }

  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  void
  remove() const
  {
    std::error_code ignored;
    for (const char* const ending : {"", "-wal", "-shm", "-journal"})
      fs::remove(name + ending, ignored);
  }

  const std::string name;
};

} // namespace

struct ArchiveDatabase::Statements {
  SqliteDatabase& database;
  SqliteStatement put_block{
      database, "INSERT INTO blocks(z, y, x, content) VALUES(?, ?, ?, ?) "
                "ON CONFLICT(z, y, x) DO UPDATE SET content = excluded.content"};
  SqliteStatement get_block{
      database, "SELECT content FROM blocks WHERE z = ? AND y = ? AND x = ?"};
  Sealer sealer{};
};

void
makeArchiveFile(const std::string& path,
                const std::function<void(const std::string&)>& make)
{
  refuseExisting(path);
  const Temporary temporary(path);
  const auto named = [&](std::string message) {
    const std::size_t at = message.find(temporary.name);
    return at == std::string::npos ? message
                                   : message.replace(at, temporary.name.size(), path);
  };
  try {
    make(temporary.name);
  }
  catch (const OutputException& error) {
    fail<OutputException>(named(error.what()));
  }
  catch (const BadInputException& error) { // for example if it cannot be read back
    badInput(named(error.what()));
  }
  rename(temporary.name, path);
  synchronizeFolderOf(path);
}

std::string
nameOfBlock(const VoxelIndex& index)
{
  return "block " + std::to_string(index.x()) + " " + std::to_string(index.y()) + " " +
         std::to_string(index.z());
}

void
ArchiveDatabase::create(const std::string& path,
                        const std::function<void(ArchiveDatabase&)>& fill)
{
  makeArchiveFile(path, [&](const std::string& temporary) {
    ArchiveDatabase archive(temporary);
    fill(archive);
    archive.database_.run("COMMIT");
  });
}

ArchiveDatabase::ArchiveDatabase(const std::string& path)
    : database_(path, Access::create)
{
  database_.run("PRAGMA page_size = 4096; BEGIN IMMEDIATE; " +
                SqliteDatabase::markingAs({FileMark::whole}) +
                "; PRAGMA user_version = " + std::to_string(kVersion));
  for (const std::string& table : tables)
    database_.run(table);
  statements_.reset(new Statements{database_});
}

ArchiveDatabase::ArchiveDatabase(const std::string& path, Access access)
    : database_((requireReadableFile(path), path), access)
{
  checkTables();
  if (access == Access::read)
    database_.run("BEGIN");
  else {
    if (!database_.splitLog())
      fail<OutputException>(path, ": another program is using it; try again when it "
                                  "has finished");
    database_.run("PRAGMA synchronous = FULL; PRAGMA journal_size_limit = 67108864; "
                  "BEGIN IMMEDIATE");
    // Older programs cannot read new blocks.
    if (database_.number("PRAGMA user_version") != kVersion)
      database_.run("PRAGMA user_version = " + std::to_string(kVersion));
  }
  statements_.reset(new Statements{database_});
}

ArchiveDatabase::~ArchiveDatabase() = default;

void
ArchiveDatabase::checkTables()
{
  const FileMark mark = database_.mark();
  if (!mark.is(FileMark::whole) && !mark.is(FileMark::old_log) &&
      !mark.is(FileMark::logged) && !mark.is(FileMark::with_log))
    badInput(path(), ": is no map archive");
  const std::int64_t version = database_.number("PRAGMA user_version");
  if (version > kVersion || version == 1)
    badInput(path(), ": is an archive of version ", version, ", ",
             (version > kVersion ? "newer" : "older"),
             " than this program, which reads versions ", kOldestVersion, " and ",
             kVersion);
  SqliteStatement schema(
      database_, "SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY name");
  std::vector<std::string> found;
  schema.forEachRow([&] { found.emplace_back(schema.bytes(0)); });
  if (version < kOldestVersion || found != tables)
    badInput(path(), ": is damaged: its tables are not those of version ", kVersion);
}

void
ArchiveDatabase::commit()
{
  // The next transaction begins immediately, so that no other program writes in
  // between.
  database_.commit();
  database_.run("BEGIN IMMEDIATE");
}

bool
ArchiveDatabase::close()
{
  database_.run("ROLLBACK");
  return database_.joinLog();
}

void
ArchiveDatabase::putMeta(const std::string& name, const Bytes& content)
{
  ByteWriter writer;
  writer.putText(name);
  writer.putBytes(content);
  if (writer.bytes().size() > kMaxMeta)
    badParameter(path(), ": '", name, "' has ", writer.bytes().size(),
                 " bytes, expected at most ", kMaxMeta);
  SqliteStatement(database_, "INSERT OR REPLACE INTO meta VALUES(?, ?)")
      .run(name, statements_->sealer.seal(writer.bytes()));
}

void
ArchiveDatabase::getMeta(const std::string& name,
                         const std::function<void(const Bytes&)>& decode)
{
  SqliteStatement row(database_, "SELECT value FROM meta WHERE name = ?");
  std::optional<Bytes> content;
  const auto read = [&] {
    content = unseal(row.bytes(0), kMaxMeta);
    ByteReader reader(*content);
    if (reader.getText() != name)
      badInput("has an entry of another name");
    decode(reader.getRest());
  };
  row.forEachRow([&] { readAt(path() + ": '" + name + "'", read); }, name);
  if (!content)
    badInput(path(), ": is damaged: has no '", name, "'");
}

bool
ArchiveDatabase::hasMeta(const std::string& name)
{
  SqliteStatement row(database_, "SELECT 1 FROM meta WHERE name = ?");
  bool is_there = false;
  row.forEachRow([&] { is_there = true; }, name);
  return is_there;
}

void
ArchiveDatabase::eraseMeta(const std::string& name)
{
  SqliteStatement(database_, "DELETE FROM meta WHERE name = ?").run(name);
}

std::uint64_t
ArchiveDatabase::countMeta(const std::string& begin)
{
  SqliteStatement row(database_, "SELECT count(*) FROM meta WHERE name LIKE ?");
  std::uint64_t count = 0;
  row.forEachRow([&] { count = std::uint64_t(row.integer(0)); }, begin + "%");
  return count;
}

void
ArchiveDatabase::putFrame(int number, const Bytes& content)
{
  ByteWriter writer;
  writer.put(std::int64_t(number));
  writer.putBytes(content);
  SqliteStatement(database_, "INSERT OR REPLACE INTO frames VALUES(?, ?)")
      .run(number, statements_->sealer.seal(writer.bytes()));
}

std::uint64_t
ArchiveDatabase::countFrames()
{
  return std::uint64_t(database_.number("SELECT count(*) FROM frames"));
}

std::int64_t
ArchiveDatabase::lastFrame()
{
  return database_.number("SELECT ifnull(max(number), -1) FROM frames");
}

void
ArchiveDatabase::forEachFrame(const std::function<void(int, const Bytes&)>& visit)
{
  SqliteStatement row(database_, "SELECT number, value FROM frames ORDER BY number");
  row.forEachRow([&] {
    const std::int64_t number = row.integer(0);
    readAt(path() + ": frame " + std::to_string(number), [&] {
      const Bytes content = unseal(row.bytes(1), kMaxFrame);
      ByteReader reader(content);
      if (reader.get<std::int64_t>() != number || int(number) != number)
        badInput("holds another frame");
      visit(int(number), reader.getRest());
    });
  });
}

void
ArchiveDatabase::putBlock(const VoxelIndex& index, const Bytes& sealed)
{
  statements_->put_block.run(index.z(), index.y(), index.x(), sealed);
}

std::optional<std::string>
ArchiveDatabase::getBlock(const VoxelIndex& index)
{
  SqliteStatement& row = statements_->get_block;
  std::optional<std::string> sealed;
  row.forEachRow([&] { sealed = row.bytes(0); }, index.z(), index.y(), index.x());
  return sealed;
}

Bytes
ArchiveDatabase::unsealBlock(const VoxelIndex& index, std::string_view sealed) const
{
  return readAt(path() + ": " + nameOfBlock(index),
                [&] { return unseal(sealed, kMaxBlock); });
}

VoxelIndex
ArchiveDatabase::keyOf(const SqliteStatement& row) const
{
  const std::int64_t zyx[] = {row.integer(0), row.integer(1), row.integer(2)};
  for (const std::int64_t value : zyx)
    if (value < -kMaxVoxelIndex || value > kMaxVoxelIndex)
      badInput(path(), ": is damaged: has a block at ", zyx[2], " ", zyx[1], " ",
               zyx[0]);
  return {int(zyx[2]), int(zyx[1]), int(zyx[0])};
}

void
ArchiveDatabase::forEachBlockKey(const std::function<void(const VoxelIndex&)>& visit)
{
  SqliteStatement row(database_, "SELECT z, y, x FROM blocks ORDER BY z, y, x");
  row.forEachRow([&] { visit(keyOf(row)); });
}

void
ArchiveDatabase::forEachBlock(
    const std::function<void(const VoxelIndex&, std::string_view)>& visit)
{
  SqliteStatement row(database_,
                      "SELECT z, y, x, content FROM blocks ORDER BY z, y, x");
  row.forEachRow([&] { visit(keyOf(row), row.bytes(3)); });
}

std::vector<std::string>
ArchiveDatabase::integrityFaults()
{
  SqliteStatement check(database_, "PRAGMA integrity_check");
  std::vector<std::string> faults;
  check.forEachRow([&] {
    for (const std::string_view line : splitAt('\n', check.bytes(0)))
      if (line != "ok" && line.rfind("***", 0) != 0) // not a heading
        faults.emplace_back(line);
  });
  if (const int lost = database_.lostCommits(); lost > 0)
    faults.push_back(path() + "-wal lacks " + std::to_string(lost) +
                     (lost == 1 ? " commit" : " commits") + " of the archive");
  return faults;
}

} // namespace pcl_semantic
