// SPDX-License-Identifier: BSD-3-Clause
#include "block_encoding.h"
#include "core/fail.h"

#include <algorithm>
#include <cmath>
#include <new>

#include <zstd.h>

namespace pcl_semantic {

namespace {

using Numbers = std::vector<std::uint32_t>;

constexpr std::size_t kIndexSize = 3 * sizeof(std::int32_t);
constexpr std::size_t kCountsSize = sizeof(std::uint8_t) + sizeof(std::uint16_t);
constexpr std::size_t kRecordNumbers = 6;
constexpr std::size_t kPositionSize = 3 * sizeof(std::uint16_t);
constexpr std::size_t kDeviationSize = sizeof(std::uint16_t); // not in version 2

void
checkBlock(const VoxelBlock& block, int classes)
{
  const std::size_t records = block.records.size();
  const std::size_t floats = records * static_cast<std::size_t>(classes);
  const auto marked = std::count_if(block.record_of.begin(), block.record_of.end(),
                                    [](int record) { return record >= 0; });
  if (records > kBlockVoxels || std::size_t(marked) != records ||
      block.measured.size() != floats || block.refined.size() != floats ||
      (records > 0 && block.record_of.size() != kBlockVoxels))
    badParameter("a block of ", records, " records and ", block.measured.size(),
                 " values does not fit ", classes, " classes");
  for (const std::vector<float>* const values : {&block.measured, &block.refined})
    if (!std::all_of(values->begin(), values->end(),
                     [](float value) { return std::isfinite(value); }))
      badParameter("a block holds a value that is not finite");
}

// The numbers of a record, in the order of their columns.
template <typename Record>
auto
numbersOf(Record& record)
{
  return std::array{&record.colour_sum[0], &record.colour_sum[1],
                    &record.colour_sum[2], &record.colour_count,
                    &record.observations,  &record.label_observations};
}

void
putDistributions(const std::vector<float>& values, const std::vector<int>& order,
                 int classes, ByteWriter& writer)
{
  std::vector<float> column(order.size());
  for (int k = 0; k < classes; ++k) {
    for (std::size_t i = 0; i < order.size(); ++i)
      column[i] = values[std::size_t(order[i] * classes + k)];
    writer.putColumn(column);
  }
}

std::vector<float>
getDistributions(ByteReader& reader, std::size_t records, int classes)
{
  std::vector<float> values(records * std::size_t(classes));
  for (std::size_t k = 0; k < std::size_t(classes); ++k) {
    const std::vector<float> column = reader.getColumn<float>(records);
    for (std::size_t i = 0; i < records; ++i) {
      if (!std::isfinite(column[i]))
        badInput("holds a value that is not finite");
      values[i * std::size_t(classes) + k] = column[i];
    }
  }
  return values;
}

void
putRecords(const VoxelBlock& block, int classes, ByteWriter& writer)
{
  std::vector<int> order;
  std::array<std::uint8_t, kBlockVoxels / 8> mask{};
  for (int offset = 0; offset < kBlockVoxels; ++offset)
    if (block.recordAt(offset) != VoxelBlock::kNoRecord) {
      order.push_back(block.recordAt(offset));
      mask[std::size_t(offset / 8)] |= std::uint8_t(1u << (offset % 8));
    }
  for (const std::uint8_t byte : mask)
    writer.put(byte);
  Numbers column(order.size());
  for (std::size_t c = 0; c < kRecordNumbers; ++c) {
    for (std::size_t i = 0; i < order.size(); ++i)
      column[i] = *numbersOf(block.records[std::size_t(order[i])])[c];
    writer.putColumn(column);
  }
  std::vector<std::uint16_t> positions(order.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < order.size(); ++i)
      positions[i] = block.records[std::size_t(order[i])].position[axis];
    writer.putColumn(positions);
  }
  putDistributions(block.measured, order, classes, writer);
  putDistributions(block.refined, order, classes, writer);
  std::vector<std::uint16_t> deviations(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    deviations[i] = block.records[std::size_t(order[i])].label_deviation;
  writer.putColumn(deviations);
}

void
getRecords(ByteReader& reader, std::size_t records, int classes, VoxelBlock& block)
{
  block.record_of.assign(kBlockVoxels, VoxelBlock::kNoRecord);
  std::size_t next = 0;
  std::uint8_t byte = 0;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    if (offset % 8 == 0)
      byte = reader.get<std::uint8_t>();
    if (byte >> (offset % 8) & 1)
      block.record_of[std::size_t(offset)] = static_cast<std::int16_t>(next++);
  }
  if (next != records)
    badInput("marks ", next, " voxels, expected ", records);
  block.records.resize(records);
  for (std::size_t c = 0; c < kRecordNumbers; ++c) {
    const Numbers column = reader.getColumn<std::uint32_t>(records);
    for (std::size_t i = 0; i < records; ++i)
      *numbersOf(block.records[i])[c] = column[i];
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto column = reader.getColumn<std::uint16_t>(records);
    for (std::size_t i = 0; i < records; ++i)
      block.records[i].position[axis] = column[i];
  }
  block.measured = getDistributions(reader, records, classes);
  block.refined = getDistributions(reader, records, classes);
  if (reader.left() == 0) // version 2
    return;
  const auto deviations = reader.getColumn<std::uint16_t>(records);
  for (std::size_t i = 0; i < records; ++i)
    block.records[i].label_deviation = deviations[i];
}

std::size_t
encodedBlockSize(std::size_t records, int classes)
{
  const std::size_t fixed =
      kIndexSize + kCountsSize + kBlockVoxels * sizeof(StoredLogOdds);
  if (records == 0)
    return fixed;
  return fixed + kBlockVoxels / 8 +
         records * (kRecordNumbers * sizeof(std::uint32_t) + kPositionSize +
                    2 * std::size_t(classes) * sizeof(float) + kDeviationSize);
}

// Measured (doc/map.md): level 5 takes twice the time for 3 % less.
constexpr int kCompressionLevel = 3;

[[noreturn]] void
failDamaged(const char* why)
{
  badInput("is damaged: ", why);
}

// The fifth byte of a frame is its descriptor; bit 2 means that a checksum follows.
bool
hasChecksum(const void* data, std::size_t size)
{
  constexpr std::size_t descriptor = 4;
  constexpr std::uint8_t checksum_flag = 1 << 2;
  return size > descriptor &&
         (static_cast<const std::uint8_t*>(data)[descriptor] & checksum_flag);
}

struct ContextDeleter {
  void
  operator()(ZSTD_DCtx* context) const
  {
    ZSTD_freeDCtx(context);
  }
};

} // namespace

Bytes
encodeBlock(const VoxelIndex& index, const VoxelBlock& block, int classes)
{
  checkBlock(block, classes);
  ByteWriter writer(encodedBlockSize(block.records.size(), classes));
  for (const std::int32_t coordinate : {index.z(), index.y(), index.x()})
    writer.put(coordinate);
  writer.put(static_cast<std::uint8_t>(classes));
  writer.put(static_cast<std::uint16_t>(block.records.size()));
  writer.putColumn(
      std::vector<StoredLogOdds>(block.log_odds.begin(), block.log_odds.end()));
  if (!block.records.empty())
    putRecords(block, classes, writer);
  return writer.bytes();
}

std::unique_ptr<VoxelBlock>
decodeBlock(const Bytes& bytes, const VoxelIndex& index, int classes)
{
  ByteReader reader(bytes);
  const auto z = reader.get<std::int32_t>();
  const auto y = reader.get<std::int32_t>();
  const auto x = reader.get<std::int32_t>();
  if (VoxelIndex(x, y, z) != index)
    badInput("holds the block ", x, " ", y, " ", z);
  const int stored_classes = reader.get<std::uint8_t>();
  const std::size_t records = reader.get<std::uint16_t>();
  if (stored_classes != classes)
    badInput("has ", stored_classes, " classes, expected ", classes);
  const std::size_t size = encodedBlockSize(records, classes);
  if (records > kBlockVoxels ||
      (bytes.size() != size && bytes.size() != size - records * kDeviationSize))
    badInput("has ", bytes.size(), " bytes, which are not those of ", records,
             " records");
  auto block = std::make_unique<VoxelBlock>();
  const std::vector<StoredLogOdds> log_odds =
      reader.getColumn<StoredLogOdds>(kBlockVoxels);
  std::copy(log_odds.begin(), log_odds.end(), block->log_odds.begin());
  if (records > 0)
    getRecords(reader, records, classes, *block);
  return block;
}

struct Sealer::Context {
  ZSTD_CCtx* const zstd = ZSTD_createCCtx();

  ~Context() { ZSTD_freeCCtx(zstd); }
};

Sealer::Sealer() : context_(std::make_unique<Context>())
{
  if (!context_->zstd)
    throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_compressionLevel, kCompressionLevel);
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_checksumFlag, 1);
}

Sealer::~Sealer() = default;

Bytes
Sealer::seal(const Bytes& content)
{
  Bytes frame(ZSTD_compressBound(content.size()));
  const std::size_t size = ZSTD_compress2(context_->zstd, frame.data(), frame.size(),
                                          content.data(), content.size());
  if (ZSTD_isError(size)) // the frame is large enough, so this is a lack of memory
    throw std::bad_alloc();
  frame.resize(size);
  return frame;
}

Bytes
unseal(const void* data, std::size_t size, std::size_t most)
{
  if (ZSTD_findFrameCompressedSize(data, size) != size)
    failDamaged("not one whole zstd frame");
  if (!hasChecksum(data, size))
    failDamaged("it has no checksum");
  const unsigned long long content_size = ZSTD_getFrameContentSize(data, size);
  if (content_size == ZSTD_CONTENTSIZE_UNKNOWN ||
      content_size == ZSTD_CONTENTSIZE_ERROR || content_size > most)
    failDamaged("its size cannot be");
  thread_local const std::unique_ptr<ZSTD_DCtx, ContextDeleter> context(
      ZSTD_createDCtx());
  if (!context)
    throw std::bad_alloc();
  Bytes content(static_cast<std::size_t>(content_size));
  const std::size_t got =
      ZSTD_decompressDCtx(context.get(), content.data(), content.size(), data, size);
  if (ZSTD_isError(got))
    failDamaged(ZSTD_getErrorName(got));
  if (got != content.size())
    failDamaged("its size is another");
  return content;
}

} // namespace pcl_semantic
