// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/occupancy_reliability.h>

#include "core/fail.h"
#include "files/report_text.h"
#include "map/ray_traversal.h"

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <cmath>
#include <limits>
#include <unordered_set>

namespace pcl_semantic {

namespace {

constexpr double carrier_radius = 2.0, farthest = 1e4; // [m]

using VoxelSet = std::unordered_set<VoxelIndex, VoxelIndexHash>;

bool
holdsNear(const VoxelSet& voxels, const VoxelIndex& voxel)
{
  for (int i = 0; i < 27; ++i)
    if (voxels.count(voxel + VoxelIndex(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) > 0)
      return true;
  return false;
}

} // namespace

OccupancyReliability::OccupancyReliability(const BlockStore& map, double voxel_size)
    : voxel_size_(voxel_size), curve_(Reliability::kBins)
{
  map.forEach([this](const VoxelIndex& index, const VoxelBlock& block) {
    blocks_.emplace(index, block.log_odds);
  });
}

void
OccupancyReliability::addScan(const std::vector<Eigen::Vector3d>& points,
                              const Eigen::Isometry3d& T_world_scanner)
{
  const QuantizedPoint scanner = quantize(T_world_scanner.translation(), voxel_size_);
  VoxelSet ends;
  std::unordered_map<VoxelIndex, std::array<bool, kBlockVoxels>, VoxelIndexHash> met;
  const auto meet = [&](const VoxelIndex& voxel) {
    const auto block = blocks_.find(blockOf(voxel));
    if (block == blocks_.end())
      return true;
    const auto offset = std::size_t(voxelInBlock(voxel));
    if (block->second[offset] != kUnknown)
      met[block->first][offset] = true;
    return true;
  };
  for (const Eigen::Vector3d& point : points) {
    const double distance = point.norm();
    if (!(distance > carrier_radius && distance < farthest)) // NaN is neither
      continue;
    const QuantizedPoint end = quantize(T_world_scanner * point, voxel_size_);
    ends.insert(voxelOf(end));
    traverseSegment(scanner, end, meet);
  }
  for (const auto& [block, is_met] : met)
    for (int offset = 0; offset < kBlockVoxels; ++offset)
      if (is_met[std::size_t(offset)])
        Reliability::count(
            occupancyProbability(kLogOddsUnit *
                                 float(blocks_.at(block)[std::size_t(offset)])),
            holdsNear(ends, voxelAt(block, offset)), curve_);
}

double
undecidedError(const Reliability::Curve& curve)
{
  static_assert(Reliability::kBins % 5 == 0, "0.2 and 0.8 are borders of bins");
  constexpr int fifth = Reliability::kBins / 5;
  return expectedCalibrationError({curve.begin() + fifth, curve.end() - fifth});
}

std::string
occupancyTable(const Reliability::Curve& curve)
{
  const double error = undecidedError(curve);
  std::string text = "\noccupancy, against scans that are not in the map\n"
                     "  error where p is 0.2 to 0.8  " +
                     (std::isnan(error) ? "-" : cv::format("%.3f", error)) +
                     "\n  p      occupied  voxels\n";
  for (const Reliability::Bin& bin : curve)
    if (bin.pixels > 0)
      text += cv::format("  %.3f  %.3f  %10llu\n", bin.meanProbability(),
                         bin.frequency(), static_cast<unsigned long long>(bin.pixels));
  return text;
}

std::string
occupancyJson(const Reliability::Curve& curve)
{
  nlohmann::ordered_json json; // NaN becomes null
  json["undecided_error"] = undecidedError(curve);
  json["bins"] = nlohmann::ordered_json::array();
  for (const Reliability::Bin& bin : curve)
    json["bins"].push_back({{"voxels", bin.pixels},
                            {"probability", bin.meanProbability()},
                            {"frequency", bin.frequency()}});
  return jsonText(json);
}

} // namespace pcl_semantic
