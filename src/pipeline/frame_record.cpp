// SPDX-License-Identifier: BSD-3-Clause
#include "files/bytes.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/frame_record.h>

namespace pcl_semantic {

namespace {

template <typename Counts>
auto
membersOf(Counts& counts)
{
  return std::array{&counts.points, &counts.rays,         &counts.invalid,
                    &counts.sky,    &counts.seen_through, &counts.hit_voxels};
}

} // namespace

FrameRecord
recordOf(const MappedFrame& mapped)
{
  return {mapped.frame.number, mapped.T_world_camera, mapped.counts,
          mapped.times.seconds(), mapped.domain_shift};
}

std::vector<std::uint8_t>
encodeFrameRecord(const FrameRecord& record)
{
  ByteWriter writer;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      writer.put(record.T_world_camera(row, column));
  for (const std::size_t* const count : membersOf(record.counts))
    writer.put(static_cast<std::uint64_t>(*count));
  writer.put(static_cast<std::uint32_t>(record.seconds.size()));
  for (const auto& [stage, seconds] : record.seconds) {
    writer.putText(stage);
    writer.put(seconds);
  }
  writer.put(record.domain_shift);
  return writer.bytes();
}

FrameRecord
decodeFrameRecord(int number, const std::vector<std::uint8_t>& bytes)
{
  ByteReader reader(bytes);
  FrameRecord record;
  record.number = number;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      record.T_world_camera(row, column) = reader.get<double>();
  for (std::size_t* const count : membersOf(record.counts))
    *count = reader.get<std::uint64_t>();
  for (auto stages = reader.get<std::uint32_t>(); stages > 0; --stages) {
    const std::string stage = reader.getText();
    record.seconds.emplace_back(stage, reader.get<double>());
  }
  if (reader.left() > 0)
    record.domain_shift = reader.get<double>();
  if (reader.left() > 0 || !record.T_world_camera.matrix().allFinite())
    PCL_THROW_EXCEPTION(BadInputException, "is no record of a frame");
  return record;
}

} // namespace pcl_semantic
