// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How the pixels of one scan that hit the same voxel are taken together. */
enum class PixelFusion {
  mean,   ///< mean log-likelihood: one witness a scan
  product ///< every pixel is a witness of its own (eq. (1) of the paper, word by word)
};

/** \brief Parameters of occupancy, colour and label fusion. */
struct FusionParameters {
  double hit_probability = 0.7;      ///< of being occupied, given a hit
  double miss_probability = 0.4;     ///< of being occupied, given a ray through it
  double min_probability = 0.03;     ///< clamp of occupancy from below
  double max_probability = 0.97;     ///< clamp of occupancy from above
  double occupied_probability = 0.5; ///< occupied at or above; one hit is enough
  PixelFusion pixel_fusion = PixelFusion::mean;
  double label_min_probability = 0.01; ///< clamp of each measurement from below
  /// Every ray through a voxel is a miss and every end in it a hit, one after the other
  /// (as in the paper), instead of one update a scan: the order of the points matters.
  bool per_ray_counting = false;
  /// Log-odds that occupied voxels of dynamic classes lose at each scan, so that what
  /// has moved on leaves no trail where no ray clears it; 0 = none.
  double dynamic_decay = 0.0;
  double label_max_ratio = 1e4; ///< clamp of a fused distribution: largest / smallest

  /** \throws InvalidParameterException */
  void validate() const;
};

/** \brief Log-odds of a probability, in stored units. */
StoredLogOdds storedLogOdds(double probability);

/** \brief Probability that a point lies within half a voxel of where it was measured:
 * the weight of its hit.
 * \param[in] voxel_size [m]
 * \param[in] deviation standard deviation of its distance [m]; 0 = exact */
float hitWeight(double voxel_size, float deviation);

/** \brief Adds one hit or miss to a voxel, clamped; an unknown voxel starts at even
 * odds. */
class OccupancyUpdate {
public:
  explicit OccupancyUpdate(const FusionParameters& parameters);

  /** \param[in] weight 0..1, of a hit whose place is uncertain */
  void
  hit(StoredLogOdds& voxel, float weight = 1.0f) const
  {
    const int change = static_cast<int>(float(hit_) * weight + 0.5f);
    add(voxel, change > 1 ? change : 1);
  }

  /** \brief Takes some stored units off an occupied voxel, which may free it. */
  void
  decay(StoredLogOdds& voxel, int units) const
  {
    add(voxel, -units);
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

/** \brief Gathers what one scan says of one voxel. Sums are in fixed point, so that the
 * order of the points does not matter. */
class VoxelMeasurement {
public:
  VoxelMeasurement(int classes, const FusionParameters& parameters);

  void clear();

  /** \param[in] rgb packed as in pcl::PointXYZRGB */
  void addColour(std::uint32_t rgb);

  /** \param[in] distribution L probabilities; all zero (unlabelled) is passed over */
  void addDistribution(const float* distribution);

  /** \brief Fuses colour and label of the scan into a voxel: mean colour, eq. (1).
   * \param[in,out] log_distribution L values, see VoxelBlock::measured
   * \return whether the scan had a label for it */
  bool fuseInto(VoxelRecord& record, float* log_distribution);

private:
  const FusionParameters parameters_;
  void (*const add_logs_)(const float*, std::size_t, float, std::int64_t*);
  std::vector<std::int64_t> log_sums_; // with room for whole vectors
  std::vector<float> log_likelihood_;
  std::int64_t labelled_ = 0;
  std::array<std::uint64_t, 3> colour_sum_{};
  std::uint32_t colour_count_ = 0;
};

} // namespace pcl_semantic
