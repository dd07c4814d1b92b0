// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/cloud_survey.h"
#include "messages.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/filters/crf_config.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Command line of pcl_semantic_crf. */
struct CRFArguments {
  std::string input, output, label_set, label_mapping, scan_columns, config;
  double memory = 0.0;            ///< [GB]; 0 = half of the machine's
  bool states_confidence = false; ///< the user set the labels' confidence
  CRFConfig parameters;
};

/** \brief Whether cliques are read from a file with their indices. */
bool isCliqueFile(const std::string& cliques);

/** \throws InvalidParameterException unless cliques are none, the field, a method or a
 * file */
void requireCliques(const std::string& cliques);

/** \brief Figures of a cloud before its labels change. */
struct CRFInput {
  std::size_t points = 0;
  bool has_labels = false;
  bool has_colour = false;
  int classes = 0; ///< of the probabilities; 0 = labels only
  std::uint32_t largest_label = 0;
  std::vector<std::size_t> first_of_label; ///< CloudSurvey::first_of_label
  std::size_t without_preference = 0;      ///< points
  std::vector<std::string> doubts;         ///< PcdTable::doubts
};

/** \brief The figures of a cloud in memory. */
CRFInput inputOf(const LabelledCloud& cloud);

/** \brief The figures of a cloud that is read in parts. */
CRFInput inputOf(const CloudSurvey& survey);

/** \brief The CRF of pcl_semantic_crf over a cloud or its tiles, one after the other.
 */
class CRFRun {
public:
  /** \throws BadInputException if the cloud has no labels, or they do not fit the label
   * set */
  CRFRun(const CRFArguments& arguments, CRFInput input);

  int
  classes() const
  {
    return classes_;
  }

  /** \brief Prepares for tiles of a cloud.
   * \return width of their surroundings [m] */
  double setWhole(const CloudSurvey& survey);

  /** \brief Refines a cloud.
   * \param[in,out] cloud labels, distributions and the field entropy
   * \param[in] own points of the tile, the first ones; the others are around it
   * \throws BadInputException that names the file */
  void refine(LabelledCloud& cloud, std::size_t own);

  /** \brief Warns of results that the user may not expect, and prints the results. */
  void report() const;

private:
  void setMeasurements(LabelledCloud& cloud);
  void setCliques(const LabelledCloud& cloud);
  void setTileCliques(const LabelledCloud& cloud, std::size_t own);
  void addToReport(const CRFReport& report);
  void warnOfResult(std::size_t changed) const;

  const CRFArguments& arguments_;
  const CRFInput input_;
  std::optional<LabelSet> names_;
  int classes_ = 1;
  SemanticCRF<pcl::PointXYZRGBL> crf_;
  CliqueGenerator::Ptr generator_; // of the cliques; may be null
  bool has_tiles_ = false;
  std::map<std::uint32_t, std::size_t> changed_; // by label before
  std::size_t without_place_ = 0, tiles_ = 0, cut_cliques_ = 0;
  CRFReport report_;
};

} // namespace pcl_semantic::tool
