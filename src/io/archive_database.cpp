// SPDX-License-Identifier: BSD-3-Clause
#include "archive_database.h"
#include "archive_file.h"
#include "block_encoding.h"

#include <pcl_semantic/core/exceptions.h>

#include <sstream>

namespace pcl_semantic {

namespace {

constexpr std::int64_t kVersion = 2; // 2: positions of hits

constexpr std::size_t kMaxMeta = 1 << 24;
constexpr std::size_t kMaxFrame = 1 << 16;
constexpr std::size_t kMaxBlock = 1 << 21; // 512 records of 255 classes: 1.1 MB

const std::vector<std::string> tables = {
    "CREATE TABLE blocks(id INTEGER PRIMARY KEY, z INTEGER NOT NULL, y INTEGER NOT "
    "NULL, x INTEGER NOT NULL, content BLOB NOT NULL, UNIQUE(z, y, x)) STRICT",
    "CREATE TABLE frames(number INTEGER PRIMARY KEY, value BLOB NOT NULL) STRICT",
    "CREATE TABLE meta(name TEXT PRIMARY KEY, value BLOB NOT NULL) STRICT, WITHOUT "
    "ROWID"};

} // namespace

struct ArchiveDatabase::Statements {
  explicit Statements(SqliteDatabase& database)
      : put_meta(database, "INSERT OR REPLACE INTO meta VALUES(?, ?)"),
        get_meta(database, "SELECT value FROM meta WHERE name = ?"),
        put_frame(database, "INSERT OR REPLACE INTO frames VALUES(?, ?)"),
        put_block(database,
                  "INSERT INTO blocks(z, y, x, content) VALUES(?, ?, ?, ?) "
                  "ON CONFLICT(z, y, x) DO UPDATE SET content = excluded.content"),
        get_block(database,
                  "SELECT content FROM blocks WHERE z = ? AND y = ? AND x = ?")
  {}

  SqliteStatement put_meta, get_meta, put_frame, put_block, get_block;
  Sealer sealer;
};

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
    ArchiveDatabase archive(temporary, true);
    fill(archive);
    archive.database_.run("COMMIT");
  });
}

ArchiveDatabase::ArchiveDatabase(const std::string& path, bool)
    : database_(path, Access::create), access_(Access::create)
{
  database_.run("PRAGMA page_size = 4096; BEGIN IMMEDIATE");
  makeTables();
  statements_ = std::make_shared<Statements>(database_);
}

ArchiveDatabase::ArchiveDatabase(const std::string& path, Access access)
    : database_((requireReadableFile(path), path), access), access_(access)
{
  checkTables();
  if (access_ == Access::read)
    database_.run("BEGIN");
  else {
    if (!database_.splitLog())
      PCL_THROW_EXCEPTION(OutputException,
                          path << ": another program is using it; try again when it "
                                  "has finished");
    database_.run("PRAGMA synchronous = FULL; PRAGMA wal_autocheckpoint = 1000; PRAGMA "
                  "journal_size_limit = 67108864; BEGIN IMMEDIATE");
  }
  statements_ = std::make_shared<Statements>(database_);
}

void
ArchiveDatabase::makeTables()
{
  database_.run("PRAGMA application_id = " + std::to_string(SqliteDatabase::whole) +
                "; PRAGMA user_version = " + std::to_string(kVersion));
  for (const std::string& table : tables)
    database_.run(table);
}

void
ArchiveDatabase::checkTables()
{
  const std::int64_t mark = database_.number("PRAGMA application_id");
  if (mark != SqliteDatabase::whole && mark != SqliteDatabase::with_log)
    PCL_THROW_EXCEPTION(BadInputException, path() << ": is no map archive");
  const std::int64_t version = database_.number("PRAGMA user_version");
  if (version > kVersion || version == 1)
    PCL_THROW_EXCEPTION(BadInputException,
                        path() << ": is an archive of version " << version << ", "
                               << (version > kVersion ? "newer" : "older")
                               << " than this program, which reads version "
                               << kVersion);
  SqliteStatement schema(
      database_, "SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY name");
  std::vector<std::string> found;
  while (schema.step())
    found.emplace_back(schema.bytes(0));
  if (version != kVersion || found != tables)
    PCL_THROW_EXCEPTION(BadInputException,
                        path() << ": is damaged: its tables are not those of version "
                               << kVersion);
}

void
ArchiveDatabase::commit()
{
  // The next transaction begins at once: nobody else may write in between.
  database_.run("COMMIT");
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
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        path() << ": '" << name << "' is too large");
  const Bytes sealed = statements_->sealer.seal(writer.bytes());
  const SqliteReset reset(statements_->put_meta);
  statements_->put_meta.bindText(1, name);
  statements_->put_meta.bindBytes(2, sealed);
  statements_->put_meta.step();
}

Bytes
ArchiveDatabase::getMeta(const std::string& name)
{
  SqliteStatement& row = statements_->get_meta;
  const SqliteReset reset(row);
  row.bindText(1, name);
  if (!row.step())
    PCL_THROW_EXCEPTION(BadInputException,
                        path() << ": is damaged: has no '" << name << "'");
  return readAt(path() + ": '" + name + "'", [&] {
    const std::string_view sealed = row.bytes(0);
    const Bytes content = unseal(sealed.data(), sealed.size(), kMaxMeta);
    ByteReader reader(content);
    if (reader.getText() != name)
      PCL_THROW_EXCEPTION(BadInputException, "holds something else");
    return reader.getRest();
  });
}

void
ArchiveDatabase::putFrame(int number, const Bytes& content)
{
  ByteWriter writer;
  writer.put(std::int64_t(number));
  writer.putBytes(content);
  const Bytes sealed = statements_->sealer.seal(writer.bytes());
  const SqliteReset reset(statements_->put_frame);
  statements_->put_frame.bind(1, number);
  statements_->put_frame.bindBytes(2, sealed);
  statements_->put_frame.step();
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
  while (row.step()) {
    const std::int64_t number = row.integer(0);
    readAt(path() + ": frame " + std::to_string(number), [&] {
      const std::string_view sealed = row.bytes(1);
      const Bytes content = unseal(sealed.data(), sealed.size(), kMaxFrame);
      ByteReader reader(content);
      if (reader.get<std::int64_t>() != number || int(number) != number)
        PCL_THROW_EXCEPTION(BadInputException, "holds another frame");
      visit(int(number), reader.getRest());
    });
  }
}

void
ArchiveDatabase::putBlock(const VoxelIndex& index, const Bytes& sealed)
{
  SqliteStatement& row = statements_->put_block;
  const SqliteReset reset(row);
  row.bind(1, index.z());
  row.bind(2, index.y());
  row.bind(3, index.x());
  row.bindBytes(4, sealed);
  row.step();
}

std::optional<Bytes>
ArchiveDatabase::getBlock(const VoxelIndex& index)
{
  SqliteStatement& row = statements_->get_block;
  const SqliteReset reset(row);
  row.bind(1, index.z());
  row.bind(2, index.y());
  row.bind(3, index.x());
  if (!row.step())
    return std::nullopt;
  const std::string_view sealed = row.bytes(0);
  return unsealBlock(index, {sealed.begin(), sealed.end()});
}

Bytes
ArchiveDatabase::unsealBlock(const VoxelIndex& index, const Bytes& sealed) const
{
  return readAt(path() + ": " + nameOfBlock(index),
                [&] { return unseal(sealed.data(), sealed.size(), kMaxBlock); });
}

VoxelIndex
ArchiveDatabase::keyOf(const SqliteStatement& row) const
{
  const std::int64_t zyx[] = {row.integer(0), row.integer(1), row.integer(2)};
  for (const std::int64_t value : zyx)
    if (value < -kMaxVoxelIndex || value > kMaxVoxelIndex)
      PCL_THROW_EXCEPTION(BadInputException, path() << ": is damaged: has a block at "
                                                    << zyx[2] << " " << zyx[1] << " "
                                                    << zyx[0]);
  return {int(zyx[2]), int(zyx[1]), int(zyx[0])};
}

void
ArchiveDatabase::forEachBlockKey(const std::function<void(const VoxelIndex&)>& visit)
{
  SqliteStatement row(database_, "SELECT z, y, x FROM blocks ORDER BY z, y, x");
  while (row.step())
    visit(keyOf(row));
}

void
ArchiveDatabase::forEachBlock(
    const std::function<void(const VoxelIndex&, std::string_view)>& visit)
{
  SqliteStatement row(database_,
                      "SELECT z, y, x, content FROM blocks ORDER BY z, y, x");
  while (row.step())
    visit(keyOf(row), row.bytes(3));
}

std::vector<std::string>
ArchiveDatabase::integrityFaults()
{
  SqliteStatement check(database_, "PRAGMA integrity_check");
  std::vector<std::string> faults;
  while (check.step()) {
    std::istringstream lines{std::string(check.bytes(0))};
    for (std::string line; std::getline(lines, line);)
      if (line != "ok" && line.rfind("***", 0) != 0) // a title
        faults.push_back(line);
  }
  return faults;
}

} // namespace pcl_semantic
