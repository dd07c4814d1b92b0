// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <pcl_semantic/clouds/labelled_cloud.h>

#include <pcl/PCLPointCloud2.h>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Writes labels into the bytes of clouds that have the fields of another one:
 * its `label` and its `probability`, of whatever type and spelling (findLabelField(),
 * findProbabilityFields()). */
class LabelFields {
public:
  /** \param[in] table of \a cloud as it is, see addKnownFields()
   * \throws InvalidParameterException if there is no label, or it cannot hold 255 */
  LabelFields(const pcl::PCLPointCloud2& cloud, const PcdTable& table);

  /** \brief Accepts fields that were read: others hold something else, which would be
   * lost. Probabilities that were not read are left alone.
   * \param[in] read the same cloud
   * \throws BadInputException if the labels were not understood
   * \throws InvalidParameterException if probabilities are whole numbers */
  void requireRead(const LabelledCloud& read);

  /** \throws InvalidParameterException if there are probabilities of another number of
   * classes */
  void requireClasses(int classes) const;

  /** \brief Of one point, after the checks above.
   * \param[in] point its bytes \param[in] column of \a distributions */
  void write(std::uint8_t* point, std::uint32_t label,
             const LabelDistributions& distributions, Eigen::Index column) const;

private:
  pcl::PCLPointField label_;
  std::vector<pcl::PCLPointField> probabilities_; // one field, or one a class
  void (*write_label_)(std::uint8_t* bytes, std::uint32_t label);
};

/** \brief Renames fields that a filter does not use, so that it refuses none of their
 * values. */
void passOver(const std::vector<std::string>& names, PcdTable& table);

/** \brief The bytes of the i-th point, row by row. */
inline std::size_t
offsetOfPoint(const pcl::PCLPointCloud2& cloud, std::size_t i)
{
  return i / cloud.width * cloud.row_step + i % cloud.width * cloud.point_step;
}

} // namespace pcl_semantic
