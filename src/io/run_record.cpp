// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/run_record.h>

#include "run_values.h"

#include "core/fail.h"
#include "files/bytes.h"

#include <pcl_semantic/core/parse_number.h>

#include <array>
#include <cstddef>
#include <map>

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

RunSensor
sensorOf(const std::string& description)
{
  const std::map<std::string, std::string> values = runValues(description);
  const auto pose = values.find("camera_pose");
  if (pose == values.end())
    badInput("has no camera_pose, expected the archive of a run");
  const std::vector<double> numbers = parseNumbers(pose->second, "camera_pose");
  if (numbers.size() != 12)
    badInput("camera_pose has ", numbers.size(), " numbers, expected 12");
  RunSensor sensor;
  for (int i = 0; i < 12; ++i)
    sensor.T_camera0_camera(i / 4, i % 4) = numbers[std::size_t(i)];
  const auto kind = values.find("sensor"); // of clouds
  sensor.has_own_poses =
      values.count("rgbd") > 0 || (kind != values.end() && kind->second == "own");
  return sensor;
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
  writer.put(record.timestamp);
  writer.put(record.digest.data);
  writer.put(record.digest.labels);
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
  if (reader.left() > 0)
    record.timestamp = reader.get<double>();
  if (reader.left() > 0)
    record.digest = {reader.get<std::uint64_t>(), reader.get<std::uint64_t>()};
  if (reader.left() > 0 || !record.T_world_camera.matrix().allFinite())
    badInput("is no record of a frame");
  return record;
}

} // namespace pcl_semantic
