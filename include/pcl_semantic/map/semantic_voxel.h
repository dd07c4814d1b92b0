// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_index.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Log-odds of occupancy as stored: units of 1/4096. */
using StoredLogOdds = std::int16_t;
constexpr float kLogOddsUnit = 1.0f / 4096.0f;

/** \brief Occupancy probability of space that no ray has reached; measured, see
 * doc/map.md. */
constexpr float kOccupancyPrior = 0.27f;

/** \brief Occupancy probability from the log-odds of a voxel (0 = unknown). Scans count
 * from even odds, so that one hit makes a voxel occupied. Because most of space is
 * free, calibrated probabilities start at kOccupancyPrior instead. */
inline float
occupancyProbability(float log_odds)
{
  return 1.0f / (1.0f + (1.0f / kOccupancyPrior - 1.0f) * std::exp(-log_odds));
}

constexpr StoredLogOdds kUnknown = std::numeric_limits<StoredLogOdds>::min();

constexpr std::uint16_t kVoxelCentre = 1 << 15; ///< see VoxelRecord::position

/** \brief Record of a voxel that a scan has hit, without its labels. */
struct VoxelRecord {
  std::array<std::uint32_t, 3> colour_sum{}; ///< red, green, blue
  std::uint32_t colour_count = 0;            ///< pixels in the sums
  std::uint32_t observations = 0;            ///< scans that hit the voxel
  std::uint32_t label_observations = 0;      ///< of these scans, those with labels
  /// Mean position of the hits in the voxel, from its lower corner [2^-16 voxel].
  std::array<std::uint16_t, 3> position{kVoxelCentre, kVoxelCentre, kVoxelCentre};
  /// Smallest standard deviation of a depth with a label [2^-12 voxel]; 0 = exact. The
  /// weights of all labels are relative to it.
  std::uint16_t label_deviation = 0;
};

/** \brief 8 x 8 x 8 voxels: occupancy for all, records only for those that were hit, so
 * that memory grows with surfaces instead of volume. */
struct VoxelBlock {
  static constexpr std::int16_t kNoRecord = -1;

  std::array<StoredLogOdds, kBlockVoxels> log_odds;
  std::vector<std::int16_t>
      record_of; ///< row in \a records by offset; empty without hits
  std::vector<VoxelRecord> records;
  std::vector<float> measured; ///< L per row: fused log-probabilities, the largest is 0
  std::vector<float> refined;  ///< L per row: distribution of the CRF; all zero = none
  bool changed = false;        ///< since the last write to a BlockStore

  VoxelBlock() { log_odds.fill(kUnknown); }

  /** \brief Row of a voxel in the vectors above; kNoRecord if it was never hit.
   * \param[in] offset in the block, see voxelInBlock() */
  int
  recordAt(int offset) const
  {
    return record_of.empty() ? kNoRecord : record_of[std::size_t(offset)];
  }

  /** \brief Row of a voxel; adds a record if there is none.
   * \param[in] offset in the block, see voxelInBlock()
   * \param[in] classes L */
  int
  makeRecord(int offset, int classes)
  {
    if (record_of.empty())
      record_of.assign(kBlockVoxels, kNoRecord);
    std::int16_t& record = record_of[std::size_t(offset)];
    if (record == kNoRecord) {
      record = static_cast<std::int16_t>(records.size());
      records.emplace_back();
      measured.resize(measured.size() + std::size_t(classes), 0.0f);
      refined.resize(refined.size() + std::size_t(classes), 0.0f);
    }
    return record;
  }
};

/** \brief Memory of a block [bytes]. */
inline std::size_t
memoryOf(const VoxelBlock& block)
{
  return sizeof(VoxelBlock) + block.record_of.capacity() * sizeof(std::int16_t) +
         block.records.capacity() * sizeof(VoxelRecord) +
         (block.measured.capacity() + block.refined.capacity()) * sizeof(float);
}

enum class Occupancy { unknown, free, occupied };

struct VoxelState {
  VoxelIndex index = VoxelIndex::Zero(); ///< global
  Occupancy occupancy = Occupancy::unknown;
  float log_odds = 0.0f; ///< accumulated; 0 if unknown; see occupancyProbability()
  /// Mean position of its hits, world frame [m]; its centre if there were none.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::array<std::uint8_t, 3> colour{}; ///< mean red, green, blue; black without colour
  std::uint32_t observations = 0;       ///< scans that hit the voxel
  Label label = kUnlabelled;            ///< MAP of \a refined
  std::vector<float> measured;          ///< L fused probabilities; all 0: no label
  std::vector<float> refined;           ///< the CRF's, else \a measured
  float entropy = 0.0f;                 ///< of \a refined [nat]; log L without a label
};

} // namespace pcl_semantic
