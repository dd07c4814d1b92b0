/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/files/pcd_table.h>

#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What the labelled points of a `.pcd` file say, by the names of its fields. */
struct LabelledTable {
  std::string path;
  PcdTable table;

  /** \throws BadInputException as readPcd; without x, y, z, or without both label and
   * probability */
  explicit LabelledTable(const std::string& path);

  bool hasColour() const;

  /** \brief Places, labels and, where there are some, colours; organized as the file.
   * \throws BadInputException at a label that is no whole number from 0 to 255 */
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud() const;

  /** \brief L x N: the field probability, or else the labels.
   * \param[in] classes L; 0 = as many as the file shows
   * \param[in] confidence of labels
   * \throws BadInputException if they do not fit, or are no probabilities */
  LabelDistributions distributions(int classes, double confidence) const;

  /** \brief The points of each number of the field clique; 0 is in none.
   * \throws BadInputException if there is no such field */
  std::vector<pcl::PointIndices> cliques() const;

  /** \brief Puts the fields label and probability, and entropy where there is one. */
  void setResult(const pcl::PointCloud<pcl::PointXYZRGBL>& labels,
                 const LabelDistributions& distributions);
};

} // namespace pcl_semantic::tool
