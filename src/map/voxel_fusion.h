// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/scan.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Log-odds of a probability, in stored units. */
StoredLogOdds storedLogOdds(double probability);

/** \brief Weight of a hit: the probability that the true point is within half a voxel
 * of its measurement.
 * \param[in] voxel_size [m]
 * \param[in] deviation standard deviation of its distance [m]; 0 = exact */
float hitWeight(double voxel_size, float deviation);

/** \brief Standard deviations of the depths of a scan's labels, as
 * VoxelRecord::label_deviation: 1 to 65535; 0 if they are exact or not weighted. */
class LabelDeviations {
public:
  /** \param[in] scan must outlive the object */
  LabelDeviations(const MapParameters& parameters, const Scan& scan);

  std::uint16_t of(std::size_t point) const;

private:
  const Scan& scan_;
  const double error_, voxel_size_; // error_ as Scan::depth_error
};

/** \brief Weight of labels relative to those of the best look at a voxel: the inverse
 * ratio of the variances of the depths, at least 0.02.
 * \param[in] best, deviation as VoxelRecord::label_deviation, best <= deviation */
double labelWeight(std::uint16_t best, std::uint16_t deviation);

/** \brief Adds one hit or miss to a voxel, clamped; an unknown voxel starts at even
 * odds. */
class OccupancyUpdate {
public:
  explicit OccupancyUpdate(const FusionParameters& parameters);

  /** \param[in] weight 0..1, of a hit with an uncertain position */
  void
  hit(StoredLogOdds& voxel, float weight = 1.0f) const
  {
    const int change = static_cast<int>(float(hit_) * weight + 0.5f);
    add(voxel, change > 1 ? change : 1);
  }

  /** \brief Makes a voxel free: two misses below the threshold. */
  void
  setFree(StoredLogOdds& voxel) const
  {
    voxel = static_cast<StoredLogOdds>(std::max(min_, occupied_ + 2 * miss_));
  }

  /** \brief Makes a voxel occupied: at the threshold. */
  void
  setOccupied(StoredLogOdds& voxel) const
  {
    voxel = static_cast<StoredLogOdds>(occupied_);
  }

  void
  miss(StoredLogOdds& voxel) const
  {
    add(voxel, miss_);
  }

  bool
  isOccupied(StoredLogOdds voxel) const
  {
    return (voxel != kUnknown) & (voxel >= occupied_);
  }

private:
  void
  add(StoredLogOdds& voxel, int change) const
  {
    const int sum = (voxel == kUnknown ? 0 : voxel) + change;
    voxel = static_cast<StoredLogOdds>(sum < min_ ? min_ : sum > max_ ? max_ : sum);
  }

  int hit_;
  int miss_;
  int min_;
  int max_;
  int occupied_;
};

/** \brief Fixed-point resolution of a summed logarithm: 2^-24 is finer than single
 * precision. */
constexpr int kLogFractionBits = 24;

/** \brief Adds the logarithm of max(value, smallest) to each of \a count sums, with an
 * error of at most five units. Integers, so that the order of points does not matter.
 * \param[in] smallest positive and normal */
void addLogs(const float* values, std::size_t count, float smallest,
             std::int64_t* sums);

/** \brief Accumulates the measurements of one scan for one voxel, in fixed point, so
 * that the order of points does not matter. */
class VoxelMeasurement {
public:
  VoxelMeasurement(int classes, const FusionParameters& parameters);

  void clear();

  /** \param[in] position of a hit in the voxel [2^-10 voxel] */
  void addPosition(const std::array<std::uint16_t, 3>& position);

  /** \param[in] rgb packed as in pcl::PointXYZRGB */
  void addColour(std::uint32_t rgb);

  /** \param[in] distribution L probabilities; all zero (unlabelled) is ignored
   * \param[in] deviation of the point's depth, see LabelDeviations */
  void addDistribution(const float* distribution, std::uint16_t deviation = 0);

  /** \brief Fuses the scan into a voxel: mean position and colour, labels by eq. (1).
   * \param[in,out] log_distribution L values, see VoxelBlock::measured
   * \return whether the scan had a label for the voxel */
  bool fuseInto(VoxelRecord& record, float* log_distribution);

  /** \brief Fuses only the labels of a scan whose points were already integrated.
   * \return as fuseInto() */
  bool fuseLabels(VoxelRecord& record, float* log_distribution);

  /** \brief The most probable label of the scan, after fuseInto() that was true. */
  Label mapLabel() const;

private:
  void fusePosition(VoxelRecord& record) const;

  double weighOlder(VoxelRecord& record, float* log_distribution) const;

  const FusionParameters parameters_;
  std::vector<std::int64_t> log_sums_;
  std::vector<float> log_likelihood_;
  std::int64_t labelled_ = 0;
  std::uint16_t deviation_ = 0; // the smallest one of a label
  std::array<std::uint64_t, 3> colour_sum_{}, position_sum_{};
  std::uint32_t colour_count_ = 0, position_count_ = 0;
};

/** \brief Makes a voxel free, without colour and labels.
 * \param[in] offset of the voxel in its block
 * \param[in] classes L */
void freeVoxel(VoxelBlock& block, int offset, int classes,
               const OccupancyUpdate& occupancy);

} // namespace pcl_semantic
