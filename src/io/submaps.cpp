// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/submaps.h>

#include "run_values.h"

#include "core/digest.h"
#include "core/fail.h"
#include "core/text_stream.h"
#include "filters/crf_region.h"
#include "map/block_reader.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/run_record.h>
#include <pcl_semantic/version.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

FrameRecord
anchorOf(const MapArchive& submap)
{
  std::vector<FrameRecord> frames;
  submap.forEachFrame([&](int number, const std::vector<std::uint8_t>& bytes) {
    frames.push_back(decodeFrameRecord(number, bytes));
  });
  if (frames.empty())
    badInput("holds no frame whose pose could be corrected");
  return frames[frames.size() / 2];
}

// The parameters of a run's CRF; parameters missing in its description have the
// defaults of maps. nullopt: the run had no CRF.
std::optional<SemanticCRFParameters>
crfOfRun(const std::string& description)
{
  const std::map<std::string, std::string> values = runValues(description);
  const auto model = values.find("crf");
  if (model != values.end() && (model->second == "none" || model->second == "unary"))
    return {};
  SemanticCRFParameters crf = SemanticCRFParameters::forMaps();
  crf.sensor = PointSensor::stereo; // as maps were refined before they named it
  setFromRun(values, parametersOf(crf, "m"));
  return crf;
}

// Refines the voxels of a merged map without a refined distribution.
class MergedRefiner {
public:
  MergedRefiner(const MapArchive& map, const SemanticCRFParameters& parameters)
      : label_set_(map.header().label_set), parameters_(parameters),
        voxel_size_(map.header().parameters.voxel_size),
        reader_(label_set_.size(), map.header().parameters)
  {}

  /** \brief Width of the halo whose voxels influence a tile [blocks]. */
  int
  halo() const
  {
    // Only kernels that smooth whole streets need more.
    constexpr int widest = 4 * MapTile::tile_edge;
    return std::min(2 * blocksWithin(reach(), voxel_size_), widest);
  }

  void
  refine(MapBlocks& blocks) const
  {
    VoxelCloud voxels = read(blocks);
    const CrfRegion region = crfRegion(voxels, reach());
    if (region.updated.empty())
      return;
    SemanticCRF<pcl::PointXYZRGBL> crf;
    crf.setModel(CRFModelType::dense);
    crf.setParameters(parameters_);
    refineRegion(crf, label_set_, region, voxels);
    write(region.updated, voxels, blocks);
  }

private:
  double
  reach() const
  {
    return crfReach(parameters_, voxel_size_);
  }

  VoxelCloud
  read(const MapBlocks& blocks) const
  {
    std::vector<std::pair<VoxelIndex, const VoxelBlock*>> pointers;
    for (const auto& [index, block] : blocks)
      pointers.emplace_back(index, &block);
    return reader_.readAll(pointers, originOf(blocks));
  }

  // Near the voxels, because their points are single precision.
  Eigen::Vector3d
  originOf(const MapBlocks& blocks) const
  {
    return blocks.empty()
               ? Eigen::Vector3d::Zero().eval()
               : (blocks.front().first.cast<double>() * kBlockEdge * voxel_size_)
                     .eval();
  }

  void
  write(const pcl::Indices& updated, const VoxelCloud& voxels, MapBlocks& blocks) const
  {
    auto found = blocks.begin();
    for (const pcl::index_t i : updated) {
      const VoxelIndex& voxel = voxels.indices[std::size_t(i)];
      while (found->first != blockOf(voxel))
        ++found;
      const int record = found->second.recordAt(voxelInBlock(voxel));
      std::copy_n(voxels.refined.column(i), label_set_.size(),
                  found->second.refined.begin() +
                      std::ptrdiff_t(record) * label_set_.size());
    }
  }

  LabelSet label_set_;
  SemanticCRFParameters parameters_;
  double voxel_size_; // [m]
  BlockReader reader_;
};

} // namespace

std::vector<std::size_t>
submapStarts(const std::vector<Eigen::Vector3d>& positions, const SubmapLength& length)
{
  if ((length.metres > 0.0) == (length.frames > 0) || !(length.metres >= 0.0) ||
      length.frames < 0)
    badParameter("a submap of ", length.metres, " m or ", length.frames,
                 " frames, expected one of both");
  std::vector<std::size_t> starts;
  double driven = 0.0; // distance since the last start [m]
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (i > 0)
      driven += (positions[i] - positions[i - 1]).norm();
    const bool is_full =
        length.frames > 0
            ? !starts.empty() && i - starts.back() >= std::size_t(length.frames)
            : driven >= length.metres;
    if (i > 0 && !is_full)
      continue;
    starts.push_back(i);
    driven = 0.0;
  }
  return starts;
}

StoredPoses
correctedPoses(const std::string& description, const std::string& trajectory,
               std::vector<std::string>* doubts)
{
  const RunSensor sensor = sensorOf(description);
  return sensor.has_own_poses ? readStoredPoses(trajectory, PoseFrame::sensor,
                                                Eigen::Isometry3d::Identity(),
                                                StoredPoses::default_gap, doubts)
                              : readStoredPoses(trajectory, PoseFrame::first_camera,
                                                sensor.T_camera0_camera,
                                                StoredPoses::default_gap, doubts);
}

Eigen::Isometry3d
submapMotion(const MapArchive& submap, const std::string& trajectory,
             std::vector<std::string>* doubts)
{
  try {
    const FrameRecord anchor = anchorOf(submap);
    const StoredPoses poses =
        correctedPoses(submap.header().configuration, trajectory, doubts);
    return poses.pose({anchor.number, anchor.timestamp}) *
           anchor.T_world_camera.inverse();
  }
  catch (const BadInputException& error) {
    badInput(submap.path(), ": ", error.what());
  }
}

PlacedArchive
placed(const Submap& submap, std::vector<std::string>* doubts)
{
  PlacedArchive result{submap.path, Eigen::Isometry3d::Identity()};
  if (submap.motion)
    result.motion = *submap.motion;
  else if (!submap.trajectory.empty())
    result.motion = submapMotion(MapArchive(submap.path, ArchiveAccess::read),
                                 submap.trajectory, doubts);
  return result;
}

namespace {

// Parameters of the merge and poses of the submaps.
struct Merge {
  std::vector<PlacedArchive> archives;
  MergeOptions options;
};

// Takes the parameters from the first submap by name.
Merge
mergeOf(const std::vector<Submap>& submaps)
{
  Merge merge;
  std::shared_ptr<const MergedRefiner> refiner;
  const Submap* first = nullptr;
  for (const Submap& submap : submaps) {
    merge.archives.push_back(placed(submap));
    if (first && first->path <= submap.path)
      continue;
    first = &submap;
    const MapArchive archive(submap.path, ArchiveAccess::read);
    const auto parameters = crfOfRun(archive.header().configuration);
    refiner =
        parameters ? std::make_shared<MergedRefiner>(archive, *parameters) : nullptr;
  }
  if (refiner) {
    merge.options.halo = refiner->halo();
    merge.options.refine = [refiner](MapBlocks& blocks) { refiner->refine(blocks); };
  }
  return merge;
}

} // namespace

std::uint64_t
mergeSubmaps(const std::vector<Submap>& submaps, const std::string& output,
             const BlockProgress& progress)
{
  Merge merge = mergeOf(submaps);
  merge.options.progress = progress;
  return mergeArchives(merge.archives, output, merge.options);
}

void
mergeTiledObjects(const std::vector<Submap>& submaps, const std::string& index)
{
  std::vector<PlacedArchive> archives;
  for (const Submap& submap : submaps)
    archives.push_back(placed(submap));
  mergeTiledObjects(archives, index);
}

std::vector<MapTile>
tilesOf(const Submap& submap)
{
  return tilesOf(placed(submap));
}

namespace {

// Everything that determines the bytes of a tile, except for its position.
std::string
describe(const std::set<Submap>& submaps, const Merge& merge)
{
  TextStream text;
  text.precision(17);
  text << "version: " << PCL_SEMANTIC_VERSION << "\n";
  auto archive = merge.archives.begin();
  for (const Submap& submap : submaps) {
    text << "submap: " << submap.path << " "
         << (submap.digest != 0 ? submap.digest : archiveDigest(submap.path));
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        text << " " << archive->motion(row, column);
    text << "\n";
    ++archive;
  }
  return text.str();
}

// Adds the checksum of the current file of a tile.
std::string
withBytes(const std::string& description, const std::string& tile)
{
  const std::vector<std::uint8_t> bytes = readBytes(tile);
  Digest digest;
  digest.add(bytes.data(), bytes.size());
  return description + "bytes: " + std::to_string(digest.value()) + "\n";
}

bool
isMade(const std::string& tile, const std::string& text_path,
       const std::string& description)
{
  try {
    const std::vector<std::uint8_t> text = readBytes(text_path);
    return std::string(text.begin(), text.end()) == withBytes(description, tile);
  }
  catch (const BadInputException&) { // a file is missing or unreadable
    return false;
  }
}

} // namespace

bool
mergeTile(const SubmapTiles& tiles, const MapTile& tile, const std::string& output)
{
  std::set<Submap> near;
  const auto mergeWith = [&](int tiles_around) {
    near.clear();
    for (int y = tile.y - tiles_around; y <= tile.y + tiles_around; ++y)
      for (int x = tile.x - tiles_around; x <= tile.x + tiles_around; ++x)
        if (const auto found = tiles.find({y, x}); found != tiles.end())
          near.insert(found->second.begin(), found->second.end());
    return mergeOf({near.begin(), near.end()});
  };
  Merge merge = mergeWith(1);
  const int halo = merge.options.halo;
  if (halo > MapTile::tile_edge) // rare, wide kernels
    merge = mergeWith((halo + MapTile::tile_edge - 1) / MapTile::tile_edge);
  const std::string description = describe(near, merge);
  const std::string made = fs::path(output).replace_extension(".made").string();
  if (isMade(output, made, description))
    return false;
  fs::remove(made);
  mergeTile(merge.archives, tile, output, merge.options);
  writeTextFile(made, withBytes(description, output));
  return true;
}

} // namespace pcl_semantic
