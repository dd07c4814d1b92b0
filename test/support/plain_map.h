// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map/ray_traversal.h"
#include "map/voxel_fusion.h"
#include "support/random_scan.h"

#include <pcl_semantic/map/semantic_voxel_map.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <vector>

namespace pcl_semantic {

/** \brief Reference for SemanticVoxelMap (section III of the paper): one voxel at a
 * time, single-threaded, without blocks, window and bit masks. Read this implementation
 * first. Tests use scans whose rays stay inside the map's window. */
class PlainMap {
public:
  using Key = std::tuple<int, int, int>;

  PlainMap(const LabelSet& label_set, const SemanticVoxelMap::Parameters& parameters)
      : label_set_(label_set), parameters_(parameters), update_(parameters.fusion)
  {}

  // \param[in] depth_error see SemanticVoxelMap::setDepthError()
  void
  integrate(const LabelledScan& scan, const Eigen::Isometry3d& pose,
            double depth_error = 0.0)
  {
    std::set<Key> crossed;
    std::map<Key, std::vector<std::size_t>> hits;
    for (std::size_t i = 0; i < scan.cloud.size(); ++i)
      if (isIn(scan, i) && isInRange(scan.cloud[i].getVector3fMap()))
        hits[endOf(scan.cloud[i].getVector3fMap(), pose)].push_back(i);
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
      const Eigen::Vector3f point = scan.cloud[i].getVector3fMap();
      if (!isIn(scan, i))
        continue;
      // Rays to points beyond max_range clear space up to it, without a hit.
      const float reach = point.cwiseAbs().maxCoeff();
      const float range = float(parameters_.max_range);
      const double scale = isInRange(point)
                               ? freeFraction(hits, endOf(point, pose), pose, point)
                               : double(range / reach);
      const QuantizedPoint from = quantized(pose.translation());
      const QuantizedPoint to = quantized(pose * (point.cast<double>() * scale));
      traverseSegment(from, to, [&](const VoxelIndex& v) {
        crossed.insert({v.x(), v.y(), v.z()});
        return true;
      });
    }
    for (const auto& [key, points] : hits)
      crossed.insert(key);
    // Occupancy: one update per voxel and scan; a hit wins over a miss.
    for (const Key& key : crossed) {
      StoredLogOdds& log_odds = log_odds_.try_emplace(key, kUnknown).first->second;
      if (hits.count(key))
        update_.hit(log_odds);
      else
        update_.miss(log_odds);
    }
    for (const auto& [key, points] : hits) {
      fuse(key, points, scan, depth_error);
      fusePosition(key, points, scan, pose);
    }
  }

  std::map<Key, std::vector<float>>
  occupied() const
  {
    std::map<Key, std::vector<float>> result;
    for (const auto& [key, fused] : fused_)
      if (update_.isOccupied(log_odds_.at(key))) {
        std::vector<float> p(fused.size(), 0.0f);
        if (labelled_.count(key))
          distributionFromLog(fused.data(), int(fused.size()), p.data());
        result[key] = p;
      }
    return result;
  }

  // Mean position of the hits of a voxel over the scans, in the voxel [voxels].
  const Eigen::Vector3d&
  position(const Key& key) const
  {
    return positions_.at(key).mean;
  }

  const std::map<Key, StoredLogOdds>&
  logOdds() const
  {
    return log_odds_;
  }

  bool
  isOccupied(StoredLogOdds log_odds) const
  {
    return update_.isOccupied(log_odds);
  }

private:
  bool
  isIn(const LabelledScan& scan, std::size_t i) const
  {
    const Eigen::Vector3f point = scan.cloud[i].getVector3fMap();
    return point.allFinite() && point.cwiseAbs().maxCoeff() < 1e6f &&
           !label_set_[scan.distributions.mapLabel(Eigen::Index(i))].sky;
  }

  bool
  isInRange(const Eigen::Vector3f& point) const
  {
    return point.cwiseAbs().maxCoeff() <= float(parameters_.max_range);
  }

  Key
  endOf(const Eigen::Vector3f& point, const Eigen::Isometry3d& pose) const
  {
    const VoxelIndex end =
        pcl_semantic::voxelOf(quantized(pose * point.cast<double>()));
    return {end.x(), end.y(), end.z()};
  }

  // Clearing::careful: a ray clears nothing in its last voxel's length and its last 3
  // %; above level ground nothing in the two layers over it, up to a quarter of the
  // ray.
  double
  freeFraction(const std::map<Key, std::vector<std::size_t>>& hits, const Key& end,
               const Eigen::Isometry3d& pose, const Eigen::Vector3f& point) const
  {
    if (parameters_.fusion.clearing == Clearing::full)
      return 1.0;
    const auto [x, y, z] = end;
    bool level = true;
    for (const auto& [hit, points] : hits) {
      const auto [i, j, k] = hit;
      if (std::abs(i - x) <= 1 && std::abs(j - y) <= 1 && std::abs(k - z) >= 2 &&
          std::abs(k - z) <= 4 && i >> 3 == x >> 3 && j >> 3 == y >> 3)
        level = false;
    }
    const VoxelIndex start = pcl_semantic::voxelOf(quantized(pose.translation()));
    const double layers = std::max(std::abs(z - start.z()), 1);
    const double spared = level ? std::min(2.0 / layers, 0.25) : 0.03;
    const double length = double(point.norm());
    return std::max(1.0 - parameters_.voxel_size / length - spared, 0.0);
  }

  // Independent of the map's quantize().
  QuantizedPoint
  quantized(const Eigen::Vector3d& point) const
  {
    return (point * (1024.0 / parameters_.voxel_size))
        .array()
        .floor()
        .cast<std::int64_t>();
  }

  // Deviations are stored in units of 2^-12 voxel.
  static double
  stored(double deviation)
  {
    return deviation > 0.0 ? std::max(1.0, std::round(4096.0 * deviation)) : 0.0;
  }

  // Labels, eq. (1): the mean log-likelihood of the pixels is added to the fused
  // log-probabilities, whose maximum is then shifted to 0.
  // The weights of two scans are inverse to the variances of their depths; the scan
  // with the smallest variance has the weight 1.
  void
  fuse(const Key& key, const std::vector<std::size_t>& points, const LabelledScan& scan,
       double depth_error)
  {
    const int classes = label_set_.size();
    auto& fused = fused_.try_emplace(key, classes, 0.0f).first->second;
    std::vector<double> sums(classes, 0.0);
    int count = 0;
    double deviation = HUGE_VAL;
    for (const std::size_t i : points) {
      const float* const p = scan.distributions.column(Eigen::Index(i));
      if (mapLabel(p, classes) == kUnlabelled)
        continue;
      ++count;
      const double distance = double(scan.cloud[i].getVector3fMap().norm());
      deviation = std::min(deviation, stored(depth_error * distance * distance /
                                             parameters_.voxel_size));
      for (int k = 0; k < classes; ++k)
        sums[k] +=
            std::log(std::max(double(p[k]), parameters_.fusion.label_min_probability));
    }
    if (count == 0)
      return;
    const auto weightOf = [](double best, double other) {
      return other > 0.0 ? std::max(0.02, best * best / (other * other)) : 1.0;
    };
    double weight = 1.0;
    if (!labelled_.insert(key).second) {
      const double best = best_deviation_[key];
      weight = weightOf(std::min(best, deviation), deviation);
      for (float& log : fused)
        log *= float(weightOf(std::min(best, deviation), best));
      deviation = std::min(best, deviation);
    }
    best_deviation_[key] = deviation;
    std::vector<float> mean(classes);
    for (int k = 0; k < classes; ++k)
      mean[k] = float(weight * sums[k] / count);
    fuseLogLikelihood(mean.data(), classes,
                      float(std::log(parameters_.fusion.label_max_ratio)),
                      fused.data());
  }

  // Mean over a scan's points, then over the scans.
  void
  fusePosition(const Key& key, const std::vector<std::size_t>& points,
               const LabelledScan& scan, const Eigen::Isometry3d& pose)
  {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::size_t i : points) {
      const Eigen::Vector3f point = scan.cloud[i].getVector3fMap();
      sum += pose * point.cast<double>() / parameters_.voxel_size;
    }
    const auto [x, y, z] = key;
    const Eigen::Vector3d mean = sum / double(points.size()) - Eigen::Vector3d(x, y, z);
    Position& position = positions_[key];
    ++position.scans;
    position.mean += (mean - position.mean) / position.scans;
  }

  struct Position {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    int scans = 0;
  };

  LabelSet label_set_;
  SemanticVoxelMap::Parameters parameters_;
  OccupancyUpdate update_;
  std::map<Key, StoredLogOdds> log_odds_;
  std::map<Key, std::vector<float>> fused_;
  std::map<Key, double> best_deviation_; // of the labels, see stored()
  std::set<Key> labelled_;
  std::map<Key, Position> positions_;
};

/** \brief EXPECTs the same occupancy of every voxel, free ones too. */
inline void
expectSameOccupancy(const SemanticVoxelMap& map, const PlainMap& plain)
{
  std::size_t known = 0;
  map.forEachBlock([&](const VoxelIndex& index, const VoxelBlock& block) {
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const VoxelIndex voxel = voxelAt(index, offset);
      const auto found = plain.logOdds().find({voxel.x(), voxel.y(), voxel.z()});
      ASSERT_EQ(block.log_odds[std::size_t(offset)],
                found == plain.logOdds().end() ? kUnknown : found->second)
          << voxel.transpose();
      known += found != plain.logOdds().end();
    }
  });
  EXPECT_EQ(known, plain.logOdds().size());
  EXPECT_GT(known, 10000u);
}

} // namespace pcl_semantic
