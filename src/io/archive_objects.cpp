// SPDX-License-Identifier: BSD-3-Clause
#include "archive_objects.h"

#include "archive_meta.h"
#include "core/fail.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace pcl_semantic {

namespace {

const char* const kList = "objects";

std::string
nameOf(std::uint32_t number)
{
  return "object " + std::to_string(number);
}

void
put(const Eigen::Vector3d& vector, ByteWriter& writer)
{
  for (const double coordinate : vector)
    writer.put(coordinate);
}

// The voxels, column by column: similar numbers compress well.
void
put(const std::vector<VoxelIndex>& voxels, ByteWriter& writer)
{
  writer.put(std::uint32_t(voxels.size()));
  for (int axis = 2; axis >= 0; --axis)
    for (const VoxelIndex& voxel : voxels)
      writer.put(std::int32_t(voxel[axis]));
}

double
finite(double value)
{
  if (!std::isfinite(value))
    badInput("has a number that is not finite");
  return value;
}

Eigen::Vector3d
getVector(ByteReader& reader)
{
  Eigen::Vector3d vector;
  for (double& coordinate : vector)
    coordinate = finite(reader.get<double>());
  return vector;
}

std::vector<VoxelIndex>
getVoxels(ByteReader& reader)
{
  const auto count = reader.get<std::uint32_t>();
  std::vector<std::int32_t> column[3];
  for (int axis = 2; axis >= 0; --axis)
    column[axis] = reader.getColumn<std::int32_t>(count);
  std::vector<VoxelIndex> voxels(count);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t index = column[axis][i];
      if (index < -kMaxVoxelIndex || index > kMaxVoxelIndex)
        badInput("has a voxel at ", index, ", expected at most ", kMaxVoxelIndex);
      voxels[i][axis] = index;
    }
  return voxels;
}

// A frame counted from 0.
int
getFrame(ByteReader& reader)
{
  const auto frame = reader.get<std::int32_t>();
  if (frame < 0)
    badInput("has frame ", frame, ", expected 0 or more");
  return frame;
}

void
putSighting(const ObjectSighting& sighting, ByteWriter& writer)
{
  writer.put(std::int32_t(sighting.frame));
  writer.put(sighting.timestamp);
  for (const auto& vector : {sighting.centre, sighting.box.min(), sighting.box.max()})
    put(vector, writer);
  std::vector<VoxelIndex> voxels = sighting.voxels;
  std::sort(voxels.begin(), voxels.end(), VoxelIndexLess());
  put(voxels, writer);
}

ObjectSighting
getSighting(ByteReader& reader)
{
  ObjectSighting sighting;
  sighting.frame = getFrame(reader);
  sighting.timestamp = reader.get<double>(); // NaN: the frames have no times
  sighting.centre = getVector(reader);
  sighting.box.min() = getVector(reader);
  sighting.box.max() = getVector(reader);
  sighting.voxels = getVoxels(reader);
  return sighting;
}

std::vector<std::uint32_t>
numbersOf(const MapObjects& objects)
{
  std::vector<std::uint32_t> numbers = objects.unchanged;
  for (const MapObject& object : objects.objects)
    numbers.push_back(object.number);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// The numbers of the objects, and everything that they have in common.
Bytes
encodeList(const MapObjects& objects)
{
  ByteWriter writer;
  writer.put(objects.last_number);
  writer.put(std::int32_t(objects.frames));
  writer.put(std::uint64_t(objects.min_voxels));
  const std::vector<std::uint32_t> numbers = numbersOf(objects);
  writer.put(std::uint32_t(numbers.size()));
  writer.putColumn(numbers);
  return writer.bytes();
}

std::optional<ArchiveObjectList>
readList(ArchiveDatabase& database)
{
  std::optional<ArchiveObjectList> list;
  if (database.hasMeta(kList))
    database.getMeta(kList,
                     [&](const Bytes& bytes) { list = decodeObjectList(bytes); });
  return list;
}

} // namespace

ArchiveObjectList
decodeObjectList(const Bytes& bytes)
{
  ByteReader reader(bytes);
  ArchiveObjectList list;
  list.common.last_number = reader.get<std::uint32_t>();
  list.common.frames = getFrame(reader);
  list.common.min_voxels = reader.get<std::uint64_t>();
  list.numbers = reader.getColumn<std::uint32_t>(reader.get<std::uint32_t>());
  for (std::size_t i = 0; i < list.numbers.size(); ++i)
    if (list.numbers[i] <= (i > 0 ? list.numbers[i - 1] : 0) ||
        list.numbers[i] > list.common.last_number)
      badInput("has object ", list.numbers[i], ", expected ascending numbers up to ",
               list.common.last_number);
  requireEnd(reader);
  return list;
}

Bytes
encodeObject(const MapObject& object)
{
  ByteWriter writer(64 + 16 * object.voxels.size());
  writer.put(object.number);
  writer.put(object.label);
  const ObjectTrack& track = object.summary;
  for (const int frame : {track.first_frame, track.last_frame, track.frames})
    writer.put(std::int32_t(frame));
  writer.put(std::uint8_t(track.moving));
  put(track.motion, writer);
  writer.put(track.speed);
  put(object.voxels, writer);
  writer.putColumn(object.observations);
  writer.put(std::int32_t(object.last_frame));
  writer.put(std::int32_t(object.last_moved.value_or(-1)));
  writer.put(std::uint32_t(object.sightings.size()));
  for (const ObjectSighting& sighting : object.sightings)
    putSighting(sighting, writer);
  return writer.bytes();
}

MapObject
decodeObject(const Bytes& bytes)
{
  ByteReader reader(bytes);
  MapObject object;
  object.number = reader.get<std::uint32_t>();
  object.label = reader.get<Label>();
  ObjectTrack& track = object.summary;
  for (int* const frame : {&track.first_frame, &track.last_frame, &track.frames})
    *frame = getFrame(reader);
  track.moving = reader.get<std::uint8_t>() != 0;
  track.motion = getVector(reader);
  track.speed = reader.get<double>(); // NaN: unknown
  object.voxels = getVoxels(reader);
  object.observations = reader.getColumn<std::uint32_t>(object.voxels.size());
  object.last_frame = getFrame(reader);
  if (const auto last_moved = reader.get<std::int32_t>(); last_moved >= 0)
    object.last_moved = last_moved;
  for (auto left = reader.get<std::uint32_t>(); left > 0; --left)
    object.sightings.push_back(getSighting(reader));
  requireEnd(reader);
  return object;
}

void
writeArchiveObjects(ArchiveDatabase& database, const MapObjects& objects)
{
  const std::vector<std::uint32_t> numbers = numbersOf(objects);
  const std::set<std::uint32_t> present(numbers.begin(), numbers.end());
  for (const MapObject& object : objects.objects)
    database.putMeta(nameOf(object.number), encodeObject(object));
  if (const std::optional<ArchiveObjectList> list = readList(database))
    for (const std::uint32_t number : list->numbers)
      if (present.count(number) == 0)
        database.eraseMeta(nameOf(number));
  database.putMeta(kList, encodeList(objects));
}

namespace {

// Otherwise its motion is not defined.
void
requireFrames(const MapObject& object, int frames)
{
  int last = -1;
  bool is_good = object.last_frame <= frames && object.last_moved.value_or(0) <= frames;
  for (const ObjectSighting& sighting : object.sightings) {
    is_good = is_good && sighting.frame > last && sighting.frame < frames;
    last = sighting.frame;
  }
  if (!is_good)
    badInput("has frames out of order, or beyond ", frames);
}

} // namespace

std::optional<MapObjects>
readArchiveObjects(ArchiveDatabase& database, int classes)
{
  std::optional<ArchiveObjectList> list = readList(database);
  const std::uint64_t entries = database.countMeta("object ");
  if (!list && entries == 0)
    return {};
  if (!list || entries != list->numbers.size())
    badInput(database.path(), ": is damaged: has ", entries, " objects, expected ",
             list ? list->numbers.size() : 0);
  for (const std::uint32_t number : list->numbers)
    database.getMeta(nameOf(number), [&](const Bytes& bytes) {
      list->common.objects.push_back(decodeObject(bytes));
      const MapObject& object = list->common.objects.back();
      if (object.number != number)
        badInput("holds another object");
      requireFrames(object, list->common.frames);
      if (object.label < 1 || object.label > classes)
        badInput("has label ", int(object.label), ", expected 1 to ", classes);
    });
  return std::move(list->common);
}

} // namespace pcl_semantic
