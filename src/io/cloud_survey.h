// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/pcd_reader.h"

#include <pcl_semantic/clouds/labelled_cloud.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/filters/cloud_crf.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Points of a file that are read at once. */
constexpr std::size_t kBlockOfPoints = std::size_t(1) << 18;

/** \brief Calls a function with each block of a file: its first point and the table. */
void forEachBlock(PcdReader& reader,
                  const std::function<void(std::size_t, PcdTable)>& use);

/** \brief Places of the points of a block. */
struct PointPlaces {
  Eigen::Matrix3Xf positions; ///< relative to the sample's origin [m]; NaN = no place
  std::vector<std::uint8_t> no_returns; ///< see countNoReturns()
};

/** \brief Figures of a cloud that is read in parts, see surveyCloud(). */
struct CloudSurvey {
  bool has_labels = false;
  bool has_colour = false;
  int classes = 0;                 ///< of the probabilities; 0 = labels only
  std::uint32_t largest_label = 0; ///< of the points
  std::vector<std::size_t> first_of_label =
      std::vector<std::size_t>(256, SIZE_MAX); ///< point; SIZE_MAX = no such label
  std::string label_source;                    ///< PcdTable::label_source
  std::vector<std::string> doubts;             ///< of the reader, each once
  std::size_t no_returns = 0;                  ///< see countNoReturns()
  std::size_t without_place = 0;               ///< points that placesOf() has as NaN
  std::size_t without_preference = 0; ///< points without a label, or with equal
                                      ///< probabilities
  Eigen::VectorXd class_sums; ///< of the probabilities, or numbers of points by label,
                              ///< 256 entries from class 1
  CloudSample sample;

  /** \brief The places of a block. A point has none if it is not finite, beyond
   * CloudCRF::max_coordinate, or counted by `no_returns`. */
  PointPlaces placesOf(const PcdTable& table) const;
};

/** \brief Reads a cloud in blocks, and what tiles of it have to know but the spacing.
 * \param[in] mapping as in readLabelledCloud()
 * \param[in] step is called after each block, in two rounds
 * \throws BadInputException as readLabelledCloud(), or if blocks are read differently,
 * so that the cloud has to be read as a whole */
CloudSurvey surveyCloud(PcdReader& reader, const LabelMapping* mapping,
                        const std::function<void()>& step);

/** \brief Measures the spacing and the points without a place of a surveyed cloud, in
 * a third round over its blocks. */
void measureSpacing(PcdReader& reader, const std::function<void()>& step,
                    CloudSurvey& survey);

} // namespace pcl_semantic
