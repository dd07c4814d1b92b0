// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <cstddef>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A parameter that is searched. */
struct TuningAxis {
  std::string name;
  std::vector<std::string> candidates; ///< as text, each once; numbers ascending
  std::size_t start = 0;               ///< the candidate that the search begins with
  bool is_number = false;

  /** \brief The candidates as numbers. */
  std::vector<double> numbers() const;
};

/** \brief One candidate a parameter, as its place among them. */
using TuningChoice = std::vector<std::size_t>;

/** \brief What is searched: a configuration to begin with, and the parameters that
 * change. */
struct TuningGrid {
  MapperConfig start;
  std::vector<TuningAxis> axes;

  TuningChoice startChoice() const;

  /** \brief Of a choice; not validated. */
  MapperConfig config(const TuningChoice& choice) const;

  /** \brief Whether the values of a choice go together. */
  bool isPossible(const TuningChoice& choice) const;
};

/** \brief Reads a grid: the keys of readMapperConfig(), each with a value, which is
 * fixed, or a list of candidates, of which the one of \a start is always one more. A
 * candidate for a triple is in quotes: `window: ["84,84,24", "40,40,8"]`.
 * \param[in] start the other parameters
 * \param[in] label_set the classes that values may name
 * \throws BadInputException with file and line, at an unknown key, or a value that
 * cannot be with those of the start */
TuningGrid readTuningGrid(const std::string& path, const MapperConfig& start,
                          const LabelSet& label_set);

} // namespace pcl_semantic
