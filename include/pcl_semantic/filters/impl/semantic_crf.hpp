// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/local_origin.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/type_traits.h>

#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

// PCL instantiates its base classes only for its own point types.
#include <pcl/filters/impl/filter.hpp>
#include <pcl/impl/pcl_base.hpp>

namespace pcl_semantic {

namespace detail {

/** \brief A field of a registered point by its tag, independent of the member's
 * name. */
template <typename Tag, typename PointT>
auto
getField(const PointT& point)
{
  typename pcl::traits::datatype<PointT, Tag>::type value;
  std::memcpy(&value,
              reinterpret_cast<const std::uint8_t*>(&point) +
                  pcl::traits::offset<PointT, Tag>::value,
              sizeof(value));
  return value;
}

/** \brief Whether a field has more precision than a float. */
template <typename PointT, typename Tag>
constexpr bool
isDouble()
{
  return std::is_same<typename pcl::traits::datatype<PointT, Tag>::type, double>::value;
}

template <typename Tag, typename PointT>
void
setField(PointT& point, std::uint32_t number)
{
  const auto value =
      static_cast<typename pcl::traits::datatype<PointT, Tag>::type>(number);
  std::memcpy(reinterpret_cast<std::uint8_t*>(&point) +
                  pcl::traits::offset<PointT, Tag>::value,
              &value, sizeof(value));
}

/** \brief Red, green and blue of packed bytes (`rgba`, or `rgb` as PCL's float). */
template <typename Tag, typename PointT>
Eigen::Vector3f
getColour(const PointT& point)
{
  const auto packed = getField<Tag>(point);
  static_assert(sizeof(packed) == 4, "rgb and rgba have four bytes");
  std::uint32_t bits;
  std::memcpy(&bits, &packed, sizeof(bits));
  return {float(bits >> 16 & 255), float(bits >> 8 & 255), float(bits & 255)};
}

} // namespace detail

template <typename PointT>
CloudFields
SemanticCRF<PointT>::readFields(const PointCloud& cloud) const
{
  using namespace pcl::fields;
  constexpr bool has_rgba = pcl::traits::has_field<PointT, rgba>::value;
  constexpr bool has_rgb = pcl::traits::has_field<PointT, rgb>::value;
  const auto count = static_cast<Eigen::Index>(cloud.size());
  CloudFields fields;
  fields.width = cloud.width;
  fields.height = cloud.height;
  fields.positions.resize(3, count);
  using Number = typename pcl::traits::datatype<PointT, label>::type;
  std::vector<double> numbers; // labels before validation
  if constexpr (std::is_same<Number, std::uint32_t>::value)
    fields.labels.resize(cloud.size());
  else
    numbers.resize(cloud.size());
  constexpr bool has_doubles = detail::isDouble<PointT, x>() ||
                               detail::isDouble<PointT, y>() ||
                               detail::isDouble<PointT, z>();
  if constexpr (has_doubles) {
    Eigen::Matrix3Xd positions(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const PointT& point = cloud[std::size_t(i)];
      positions.col(i) << double(detail::getField<x>(point)),
          double(detail::getField<y>(point)), double(detail::getField<z>(point));
    }
    const Eigen::Vector3d origin = localOrigin(positions);
    fields.positions = relativeTo(origin, positions);
    fields.remainders = remaindersOf(origin, positions, fields.positions);
    fields.origin = origin;
    fields.is_single = areSingle(positions);
  }
  if constexpr (has_rgba || has_rgb)
    fields.colours.resize(3, count);
#ifdef _OPENMP // may be undefined when users compile their point types
#pragma omp parallel for schedule(static)
#endif
  for (Eigen::Index i = 0; i < count; ++i) {
    const PointT& point = cloud[std::size_t(i)];
    if constexpr (!has_doubles)
      fields.positions.col(i) << float(detail::getField<x>(point)),
          float(detail::getField<y>(point)), float(detail::getField<z>(point));
    if constexpr (std::is_same<Number, std::uint32_t>::value)
      fields.labels[std::size_t(i)] = classOf(detail::getField<label>(point));
    else
      numbers[std::size_t(i)] = double(detail::getField<label>(point));
    if constexpr (has_rgba)
      fields.colours.col(i) = detail::getColour<rgba>(point);
    else if constexpr (has_rgb)
      fields.colours.col(i) = detail::getColour<rgb>(point);
  }
  if constexpr (!std::is_same<Number, std::uint32_t>::value)
    fields.labels = this->labelsOf(numbers, std::is_same<Number, float>::value);
  return fields;
}

template <typename PointT>
void
SemanticCRF<PointT>::applyFilter(PointCloud& output)
{
  static_assert(pcl::traits::has_xyz<PointT>::value &&
                    pcl::traits::has_label<PointT>::value,
                "SemanticCRF needs a point type with x, y, z and label");
  // Of this cloud, also if it is refused.
  Eigen::Matrix3Xf remainders = std::exchange(this->remainders_, Eigen::Matrix3Xf());
  if (this->input_->empty()) {
    this->runEmpty();
    output = *this->input_;
    return;
  }
  const ThreadScope threads(this->terms_.threads);
  CloudFields fields = readFields(*this->input_);
  fields.origin += this->origin_;
  if (remainders.size() > 0)
    fields.remainders = std::move(remainders);
  this->run(fields, *this->indices_);
  output = *this->input_;
  for (const pcl::index_t index : *this->indices_)
    detail::setField<pcl::fields::label>(output[std::size_t(index)],
                                         fields.labels[std::size_t(index)]);
}

} // namespace pcl_semantic
