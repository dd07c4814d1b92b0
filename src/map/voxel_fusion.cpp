// SPDX-License-Identifier: BSD-3-Clause
#include "voxel_fusion.h"
#include "core/fail.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr double kLogScale = double(1 << kLogFractionBits);

void
requireBetween(double value, double low, double high, const char* name)
{
  if (!(value > low && value < high))
    badParameter(name, " is ", value, ", expected more than ", low, " and less than ",
                 high);
}

// Splits off a power of two; a Chebyshev polynomial for 2/3 to 4/3.
inline std::int32_t
fixedPointLog(float value)
{
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  const std::int32_t exponent = (bits - 0x3F2AAAAB) >> 23;
  bits -= exponent * (1 << 23);
  float x;
  std::memcpy(&x, &bits, sizeof x);
  x -= 1.0f;
  float p = 0.13748309f * x - 0.15394272f;
  p = p * x + 0.14055812f;
  p = p * x - 0.16414520f;
  p = p * x + 0.20007233f;
  p = p * x - 0.25007930f;
  p = p * x + 0.33333272f;
  p = p * x - 0.49999934f;
  p = (p * x + 1.0f) * x;
  constexpr std::int32_t log_two = 11629080;
  return exponent * log_two + static_cast<std::int32_t>(p * float(kLogScale));
}

} // namespace

void
FusionParameters::validate() const
{
  // Otherwise the log-odds would exceed 16 bits.
  constexpr double least = 4e-4, most = 1.0 - least;
  requireBetween(hit_probability, 0.5, most, "hit_probability");
  requireBetween(miss_probability, least, 0.5, "miss_probability");
  requireBetween(min_probability, least, 0.5, "min_probability");
  requireBetween(max_probability, 0.5, most, "max_probability");
  requireBetween(occupied_probability, min_probability, max_probability,
                 "occupied_probability");
  if (per_ray_counting && clearing == Clearing::none)
    badParameter("per_ray_counting counts rays that clear space, but clearing "
                 "is none");
  requireBetween(label_min_probability, 0.0, 0.5, "label_min_probability");
  requireBetween(label_max_ratio, 1.0, std::numeric_limits<double>::infinity(),
                 "label_max_ratio");
}

StoredLogOdds
storedLogOdds(double probability)
{
  return static_cast<StoredLogOdds>(
      std::lround(std::log(probability / (1.0 - probability)) / kLogOddsUnit));
}

float
hitWeight(double voxel_size, float deviation)
{
  if (!(deviation > 0.0f))
    return 1.0f;
  return float(std::erf(voxel_size / (2.0 * std::sqrt(2.0) * double(deviation))));
}

LabelDeviations::LabelDeviations(const MapParameters& parameters, const Scan& scan)
    : scan_(scan), error_(parameters.fusion.weigh_labels ? scan.depth_error : 0.0),
      voxel_size_(parameters.voxel_size)
{}

std::uint16_t
LabelDeviations::of(std::size_t point) const
{
  if (!(error_ > 0.0))
    return 0;
  constexpr double unit = 4096.0, most = 65535.0;
  const double squared_distance = scan_.points[point].cast<double>().squaredNorm();
  return std::uint16_t(std::clamp(
      std::round(error_ * squared_distance / voxel_size_ * unit), 1.0, most));
}

double
labelWeight(std::uint16_t best, std::uint16_t deviation)
{
  if (best == deviation)
    return 1.0;
  constexpr double least = 0.02;
  const double ratio = double(best) / double(deviation);
  return std::max(least, ratio * ratio);
}

OccupancyUpdate::OccupancyUpdate(const FusionParameters& parameters)
    : hit_(storedLogOdds(parameters.hit_probability)),
      miss_(storedLogOdds(parameters.miss_probability)),
      min_(storedLogOdds(parameters.min_probability)),
      max_(storedLogOdds(parameters.max_probability)),
      occupied_(storedLogOdds(parameters.occupied_probability))
{}

void
addLogs(const float* values, std::size_t count, float smallest, std::int64_t* sums)
{
  for (std::size_t k = 0; k < count; ++k)
    sums[k] += fixedPointLog(std::max(smallest, values[k]));
}

VoxelMeasurement::VoxelMeasurement(int classes, const FusionParameters& parameters)
    : parameters_(parameters), log_sums_(classes), log_likelihood_(classes)
{}

void
VoxelMeasurement::clear()
{
  std::fill(log_sums_.begin(), log_sums_.end(), 0);
  labelled_ = 0;
  colour_sum_ = position_sum_ = {};
  colour_count_ = position_count_ = 0;
}

void
VoxelMeasurement::addPosition(const std::array<std::uint16_t, 3>& position)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
    position_sum_[axis] += position[axis];
  ++position_count_;
}

void
VoxelMeasurement::addColour(std::uint32_t rgb)
{
  colour_sum_[0] += rgb >> 16 & 255;
  colour_sum_[1] += rgb >> 8 & 255;
  colour_sum_[2] += rgb & 255;
  ++colour_count_;
}

void
VoxelMeasurement::addDistribution(const float* distribution, std::uint16_t deviation)
{
  const float* const end = distribution + log_likelihood_.size();
  if (std::all_of(distribution, end, [](float p) { return p == 0; }))
    return;
  addLogs(distribution, log_sums_.size(), float(parameters_.label_min_probability),
          log_sums_.data());
  deviation_ = labelled_ == 0 ? deviation : std::min(deviation_, deviation);
  ++labelled_;
}

// Mean over the scans. After many scans the oldest lose weight, because surfaces may
// move.
void
VoxelMeasurement::fusePosition(VoxelRecord& record) const
{
  if (position_count_ == 0)
    return;
  constexpr std::uint32_t max_scans = 255;
  const auto scans = std::int64_t(std::min(record.observations, max_scans));
  const auto count = std::int64_t(position_count_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // From units of 2^-10, at their middle, to 2^-16.
    const std::int64_t mean =
        (64 * std::int64_t(position_sum_[axis]) + 32 * count) / count;
    const std::int64_t change = mean - record.position[axis];
    record.position[axis] = std::uint16_t(record.position[axis] + change / scans);
  }
}

bool
VoxelMeasurement::fuseInto(VoxelRecord& record, float* log_distribution)
{
  ++record.observations;
  fusePosition(record);
  // Halving sums and count keeps the mean and avoids overflow of 32 bits.
  constexpr std::uint32_t max_count = 1u << 22;
  const auto halve = [](auto& sums, std::uint32_t& count) {
    for (; count > max_count; count /= 2)
      for (auto& sum : sums)
        sum /= 2;
  };
  halve(colour_sum_, colour_count_);
  halve(record.colour_sum, record.colour_count);
  for (int channel = 0; channel < 3; ++channel)
    record.colour_sum[channel] += static_cast<std::uint32_t>(colour_sum_[channel]);
  record.colour_count += colour_count_;
  return fuseLabels(record, log_distribution);
}

// A voxel's labels are weighted relative to the best look at it: if this is the new
// one, the older ones lose weight. Returns the weight of the new labels.
double
VoxelMeasurement::weighOlder(VoxelRecord& record, float* log_distribution) const
{
  const std::uint16_t best = record.label_deviation;
  if (record.label_observations > 0 && best <= deviation_)
    return labelWeight(best, deviation_);
  record.label_deviation = deviation_;
  if (record.label_observations == 0)
    return 1.0;
  const double weight = labelWeight(deviation_, best);
  for (std::size_t k = 0; k < log_likelihood_.size(); ++k)
    log_distribution[k] = float(weight * double(log_distribution[k]));
  return 1.0;
}

bool
VoxelMeasurement::fuseLabels(VoxelRecord& record, float* log_distribution)
{
  if (labelled_ == 0)
    return false;
  const double weight = weighOlder(record, log_distribution);
  ++record.label_observations;
  const double divisor =
      parameters_.pixel_fusion == PixelFusion::mean ? double(labelled_) : 1.0;
  for (std::size_t k = 0; k < log_likelihood_.size(); ++k)
    log_likelihood_[k] = float(weight * double(log_sums_[k]) / (kLogScale * divisor));
  fuseLogLikelihood(log_likelihood_.data(), static_cast<int>(log_likelihood_.size()),
                    float(std::log(parameters_.label_max_ratio)), log_distribution);
  return true;
}

Label
VoxelMeasurement::mapLabel() const
{
  const auto most = std::max_element(log_likelihood_.begin(), log_likelihood_.end());
  return Label(most - log_likelihood_.begin() + 1);
}

void
freeVoxel(VoxelBlock& block, int offset, int classes, const OccupancyUpdate& occupancy)
{
  block.changed = true;
  occupancy.setFree(block.log_odds[std::size_t(offset)]);
  const int record = block.recordAt(offset);
  if (record == VoxelBlock::kNoRecord)
    return;
  block.records[std::size_t(record)] = VoxelRecord();
  std::fill_n(block.measured.begin() + record * classes, classes, 0.0f);
  std::fill_n(block.refined.begin() + record * classes, classes, 0.0f);
}

} // namespace pcl_semantic
