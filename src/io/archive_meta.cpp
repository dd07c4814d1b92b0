// SPDX-License-Identifier: BSD-3-Clause
#include "archive_meta.h"
#include "core/fail.h"

#include <cmath>
#include <map>
#include <optional>

namespace pcl_semantic {

void
requireEnd(const ByteReader& reader)
{
  if (reader.left() > 0)
    badInput("has ", reader.left(), " bytes behind its end");
}

namespace {

using NamedValues = std::map<std::string, double*>;

NamedValues
valuesOf(MapParameters& parameters)
{
  FusionParameters& fusion = parameters.fusion;
  return {{"voxel_size", &parameters.voxel_size},
          {"window_x", &parameters.window.x()},
          {"window_y", &parameters.window.y()},
          {"window_z", &parameters.window.z()},
          {"max_range", &parameters.max_range},
          {"hit_probability", &fusion.hit_probability},
          {"miss_probability", &fusion.miss_probability},
          {"min_probability", &fusion.min_probability},
          {"max_probability", &fusion.max_probability},
          {"occupied_probability", &fusion.occupied_probability},
          {"label_min_probability", &fusion.label_min_probability},
          {"label_max_ratio", &fusion.label_max_ratio}};
}

// An invalid value here is an error of the file, not of the caller.
template <typename Make>
auto
makeOrRefuse(Make&& make)
{
  try {
    return make();
  }
  catch (const InvalidParameterException& error) {
    badInput(error.what());
  }
}

Bytes
encodeLabelSet(const LabelSet& label_set)
{
  ByteWriter writer;
  writer.put(static_cast<std::uint8_t>(label_set.size()));
  for (int label = 1; label <= label_set.size(); ++label) {
    const LabelClass& each = label_set[Label(label)];
    writer.putText(each.name);
    for (const std::uint8_t channel : each.colour)
      writer.put(channel);
    writer.put(static_cast<std::uint8_t>(each.sky));
    const bool has_gap = each.gap > 0.0;
    writer.put(static_cast<std::uint8_t>(each.dynamic | each.thin << 1 |
                                         each.thing << 2 | has_gap << 3));
    if (has_gap)
      writer.put(each.gap);
  }
  return writer.bytes();
}

LabelSet
decodeLabelSet(const Bytes& bytes)
{
  ByteReader reader(bytes);
  std::vector<LabelClass> classes(reader.get<std::uint8_t>());
  for (LabelClass& each : classes) {
    each.name = reader.getText();
    for (std::uint8_t& channel : each.colour)
      channel = reader.get<std::uint8_t>();
    each.sky = reader.get<std::uint8_t>() != 0;
    const auto flags = reader.get<std::uint8_t>();
    each.dynamic = flags & 1;
    each.thin = flags & 2;
    each.thing = flags & 4;
    if (flags & 8)
      each.gap = reader.get<double>();
    if (!(each.gap >= 0.0 && std::isfinite(each.gap)))
      badInput("has a gap of ", each.gap, ", expected 0 or more [m]");
  }
  requireEnd(reader);
  return makeOrRefuse([&] { return LabelSet(std::move(classes)); });
}

Bytes
encodeParameters(const MapParameters& parameters)
{
  MapParameters copy = parameters;
  const NamedValues values = valuesOf(copy);
  ByteWriter writer;
  writer.put(static_cast<std::uint32_t>(values.size() + 5));
  const auto put = [&](const std::string& name, double value) {
    writer.putText(name);
    writer.put(value);
  };
  for (const auto& [name, value] : values)
    put(name, *value);
  put("pixel_fusion", static_cast<double>(parameters.fusion.pixel_fusion));
  put("per_ray_counting", parameters.fusion.per_ray_counting);
  put("free_dynamic", parameters.fusion.free_dynamic);
  put("weigh_labels", parameters.fusion.weigh_labels);
  put("clearing", static_cast<double>(parameters.fusion.clearing));
  return writer.bytes();
}

MapParameters
decodeParameters(const Bytes& bytes)
{
  MapParameters parameters;
  NamedValues missing = valuesOf(parameters);
  double pixel_fusion = 0.0, per_ray_counting = 0.0;
  double free_dynamic = 0.0, weigh_labels = 0.0;       // of older archives
  auto clearing = static_cast<double>(Clearing::full); // default of older archives
  missing["pixel_fusion"] = &pixel_fusion;
  missing["per_ray_counting"] = &per_ray_counting;
  missing["clearing"] = &clearing;
  missing["free_dynamic"] = &free_dynamic;
  missing["weigh_labels"] = &weigh_labels;
  ByteReader reader(bytes);
  for (auto count = reader.get<std::uint32_t>(); count > 0; --count) {
    const std::string name = reader.getText();
    const auto value = reader.get<double>();
    const auto known = missing.find(name);
    if (known == missing.end())
      continue;
    *known->second = value;
    missing.erase(known);
  }
  requireEnd(reader);
  missing.erase("clearing");
  missing.erase("free_dynamic");
  missing.erase("weigh_labels");
  if (!missing.empty())
    badInput("lacks ", missing.begin()->first);
  parameters.fusion.pixel_fusion =
      pixel_fusion == 0.0 ? PixelFusion::mean : PixelFusion::product;
  parameters.fusion.per_ray_counting = per_ray_counting != 0.0;
  parameters.fusion.free_dynamic = free_dynamic != 0.0;
  parameters.fusion.weigh_labels = weigh_labels != 0.0;
  parameters.fusion.clearing = clearing == 0.0   ? Clearing::none
                               : clearing == 1.0 ? Clearing::full
                                                 : Clearing::careful;
  makeOrRefuse([&] { parameters.validate(); });
  return parameters;
}

Bytes
encodeState(const ArchiveState& state)
{
  ByteWriter writer;
  for (const double coordinate :
       {state.cloud_origin.x(), state.cloud_origin.y(), state.cloud_origin.z()})
    writer.put(coordinate);
  writer.put(static_cast<std::uint8_t>(state.finished));
  writer.put(state.blocks);
  writer.put(state.key_sum);
  writer.put(state.frames);
  writer.put(state.last_frame);
  return writer.bytes();
}

ArchiveState
decodeState(const Bytes& bytes)
{
  ByteReader reader(bytes);
  ArchiveState state;
  for (int axis = 0; axis < 3; ++axis)
    state.cloud_origin[axis] = reader.get<double>();
  state.finished = reader.get<std::uint8_t>() != 0;
  state.blocks = reader.get<std::uint64_t>();
  state.key_sum = reader.get<std::uint64_t>();
  state.frames = reader.get<std::uint64_t>();
  state.last_frame = reader.get<std::int64_t>();
  requireEnd(reader);
  if (!state.cloud_origin.allFinite())
    badInput("has an origin that is not finite");
  return state;
}

} // namespace

ArchiveHeader
readHeader(ArchiveDatabase& database)
{
  ArchiveHeader header;
  database.getMeta("label_set", [&](const Bytes& bytes) {
    header.label_set = decodeLabelSet(bytes);
  });
  database.getMeta("parameters", [&](const Bytes& bytes) {
    header.parameters = decodeParameters(bytes);
  });
  database.getMeta("configuration", [&](const Bytes& bytes) {
    header.configuration.assign(bytes.begin(), bytes.end());
  });
  return header;
}

void
writeHeader(ArchiveDatabase& database, const ArchiveHeader& header)
{
  const std::string& text = header.configuration;
  database.putMeta("label_set", encodeLabelSet(header.label_set));
  database.putMeta("parameters", encodeParameters(header.parameters));
  database.putMeta("configuration", {text.begin(), text.end()});
}

ArchiveState
readState(ArchiveDatabase& database)
{
  ArchiveState state;
  database.getMeta("state", [&](const Bytes& bytes) { state = decodeState(bytes); });
  return state;
}

void
writeState(ArchiveDatabase& database, const ArchiveState& state)
{
  database.putMeta("state", encodeState(state));
}

BlockIndexSet
readBlockKeys(ArchiveDatabase& database, const ArchiveState& state)
{
  BlockIndexSet blocks;
  std::optional<VoxelIndex> last;
  database.forEachBlockKey([&](const VoxelIndex& index) {
    if (last && !VoxelIndexLess()(*last, index))
      badInput(database.path(), ": is damaged: ", nameOfBlock(index),
               " is out of order");
    last = index;
    blocks.insert(index);
  });
  checkBlockKeys(database.path(), blocks, state);
  return blocks;
}

void
checkBlockKeys(const std::string& path, const BlockIndexSet& blocks,
               const ArchiveState& state)
{
  if (blocks.size() != state.blocks || blocks.keySum() != state.key_sum)
    badInput(path, ": is damaged: has ", blocks.size(), " blocks, expected the ",
             state.blocks, " blocks of the last commit");
}

void
checkFrameCount(ArchiveDatabase& database, const ArchiveState& state)
{
  const std::uint64_t frames = database.countFrames();
  if (frames != state.frames || database.lastFrame() != state.last_frame)
    badInput(database.path(), ": is damaged: has ", frames, " frames, the last ",
             database.lastFrame(), ", expected ", state.frames, " up to ",
             state.last_frame);
}

} // namespace pcl_semantic
