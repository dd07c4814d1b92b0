// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <pcl/PCLPointCloud2.h>

#include <optional>

namespace pcl_semantic {

/** \brief Writes labels into the bytes of clouds that have the fields of another one:
 * its `label`, of whatever type and spelling (findLabelField()), and its `probability`,
 * if that is one float a class.
 */
class LabelFields {
public:
  /** \throws InvalidParameterException if there is no label, or it cannot hold 255 */
  explicit LabelFields(const pcl::PCLPointCloud2& cloud);

  /** \brief Of one point.
   * \param[in] point its bytes \param[in] column of \a distributions */
  void write(std::uint8_t* point, std::uint32_t label,
             const LabelDistributions& distributions, Eigen::Index column) const;

private:
  pcl::PCLPointField label_;
  std::optional<pcl::PCLPointField> probability_;
  void (*write_label_)(std::uint8_t* bytes, std::uint32_t label);
};

/** \brief The bytes of the i-th point, row by row. */
inline std::size_t
offsetOfPoint(const pcl::PCLPointCloud2& cloud, std::size_t i)
{
  return i / cloud.width * cloud.row_step + i % cloud.width * cloud.point_step;
}

} // namespace pcl_semantic
