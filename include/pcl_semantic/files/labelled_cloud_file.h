// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/pcd_table.h>

#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A cloud of any sensor with what is known of its labels. */
struct LabelledCloud {
  /** \brief Organized as the file was; viewpoint in its sensor_origin_ and
   * sensor_orientation_; points that are not finite keep their place. */
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZRGBL>};
  LabelDistributions distributions;       ///< L x points; no classes: hard labels only
  std::vector<pcl::PointIndices> cliques; ///< of finite points, disjoint, none empty
  bool has_colour = false;                ///< whether the cloud's colours mean anything
  bool has_labels = false;                ///< likewise its labels
  PcdTable table; ///< the file it comes from, for the fields this struct does not know
};

/** \brief Reads points with labels (readCloudTable()), all but x y z optional, in any
 * order and of any type that holds the value: x y z [m]; rgb or rgba (four bytes,
 * packed as PCL does); label (0 = unlabelled); probability (COUNT L; sums to 1 within
 * 0.1 and is normalised, all zero = unlabelled); clique (0 = none). Without label the
 * labels are the most probable ones. Cliques come in the order of their numbers.
 * \param[in] mapping of the numbers in `label` to labels, others are unlabelled; null =
 * they are labels
 * \throws BadInputException as readCloudTable(), or naming field and point: a value is
 * missing, negative, not finite where it has to be, a label is beyond L or 255 */
LabelledCloud readLabelledCloud(const std::string& path,
                                const LabelMapping* mapping = nullptr);

/** \brief The same of a table. \param[in] name of the cloud for messages */
LabelledCloud labelledCloudOf(PcdTable table, const std::string& name,
                              const LabelMapping* mapping = nullptr);

/** \brief The table that writeLabelledCloud() writes. \param[in] name for messages */
PcdTable tableOf(const LabelledCloud& labelled, const std::string& name);

/** \brief Writes a cloud, whole or not at all.
 *
 * The table is written as it is, so fields this module does not know, and coordinates
 * in double precision, survive; only `label`, `probability` (if there are
 * distributions) and `clique` (if the cliques are no longer the table's) are put in the
 * place of the old ones or behind the others. A cloud without table gets x y z and, if
 * it has colour, rgba.
 * \throws InvalidParameterException if the sizes of cloud, table and distributions
 * differ, or cliques overlap: those go to writeCliques()
 * \throws OutputException */
void writeLabelledCloud(const std::string& path, const LabelledCloud& labelled);

/** \brief Writes a cloud as the file it was read from, but for the field `clique`:
 * clique c has the number c + 1, points in none have 0.
 * \throws InvalidParameterException as writeLabelledCloud(), or if the cloud was not
 * read from a file \throws OutputException */
void writeCliques(const std::string& path, const LabelledCloud& labelled);

} // namespace pcl_semantic
