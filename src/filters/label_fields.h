// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <pcl_semantic/clouds/labelled_cloud.h>

#include <pcl/PCLPointCloud2.h>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Writes labels into the fields `label` and `probability` of another cloud's
 * bytes, in any type and spelling accepted by findLabelField() and
 * findProbabilityFields(). */
class LabelFields {
public:
  /** \param[in] table of \a cloud, see addKnownFields()
   * \throws InvalidParameterException if there is no label or its type cannot store
   * 255 */
  LabelFields(const pcl::PCLPointCloud2& cloud, const PcdTable& table);

  /** \brief Checks that the reader understood the fields to be overwritten; other
   * contents would be lost. Probabilities that were not read are kept.
   * \param[in] read the same cloud
   * \throws BadInputException if the labels were not understood
   * \throws InvalidParameterException if probabilities are integers */
  void requireRead(const LabelledCloud& read);

  /** \throws InvalidParameterException if the probabilities have another number of
   * classes */
  void requireClasses(int classes) const;

  /** \brief Writes one point, after the checks above.
   * \param[in] point its bytes
   * \param[in] column of \a distributions */
  void write(std::uint8_t* point, std::uint32_t label,
             const LabelDistributions& distributions, Eigen::Index column) const;

private:
  pcl::PCLPointField label_;
  std::vector<pcl::PCLPointField> probabilities_; // one field, or one per class
  void (*write_label_)(std::uint8_t* bytes, std::uint32_t label);
};

/** \brief Renames fields that a filter does not use, so that their values are not
 * checked. */
void passOver(const std::vector<std::string>& names, PcdTable& table);

/** \brief Byte offset of the i-th point, row by row. */
inline std::size_t
offsetOfPoint(const pcl::PCLPointCloud2& cloud, std::size_t i)
{
  return i / cloud.width * cloud.row_step + i % cloud.width * cloud.point_step;
}

} // namespace pcl_semantic
