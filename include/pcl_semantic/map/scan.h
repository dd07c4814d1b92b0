// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>

#include <Eigen/Core>

#include <cstdint>
#include <cstring>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A strided view of values in memory, such as a field of a cloud. */
template <typename T> class FieldView {
public:
  FieldView() = default;

  /** \param[in] first value
   * \param[in] stride from one value to the next [bytes] */
  FieldView(const void* first, std::size_t size, std::size_t stride)
      : first_(static_cast<const char*>(first)), size_(size), stride_(stride)
  {}

  FieldView(const std::vector<T>& values)
      : FieldView(values.data(), values.size(), sizeof(T))
  {}

  std::size_t
  size() const
  {
    return size_;
  }

  bool
  empty() const
  {
    return size_ == 0;
  }

  /** \brief Address of a value, which may be unaligned. */
  const void*
  address(std::size_t i) const
  {
    return first_ + i * stride_;
  }

  T
  operator[](std::size_t i) const
  {
    T value;
    std::memcpy(static_cast<void*>(&value), address(i), sizeof value);
    return value;
  }

private:
  const char* first_ = nullptr;
  std::size_t size_ = 0, stride_ = 0;
};

/** \brief View of a cloud of any type, the input of the map. */
struct Scan {
  FieldView<Eigen::Vector3f> points; ///< sensor frame [m]
  FieldView<std::uint32_t> rgb;      ///< packed as in PCL; empty = no colour
  const LabelDistributions* distributions = nullptr; ///< null = no labels
  /// Standard deviation of the distance along each ray [m]; null = exact.
  const std::vector<float>* deviations = nullptr;
  /// Standard deviation of a distance, divided by its square [1/m]; 0 = exact. Stereo
  /// has about that of a disparity, divided by focal length and baseline.
  double depth_error = 0.0;
};

struct ScanCounts {
  std::size_t points = 0; ///< points in the cloud
  std::size_t rays = 0;   ///< rays that were cast
  /// Skipped: NaN, infinite, beyond the map's limits, or exactly 0 0 0 (isReturn()).
  std::size_t invalid = 0;
  std::size_t sky = 0; ///< points labelled as sky: skipped
  /// Stereo only: erased before the scan was cast, see eraseSeenThrough().
  std::size_t seen_through = 0;
  std::size_t hit_voxels = 0; ///< voxels with an end point
  std::size_t freed = 0;      ///< voxels of dynamic classes that the scan has freed
};

} // namespace pcl_semantic
