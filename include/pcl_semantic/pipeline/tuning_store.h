// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/pipeline/tuning_score.h>

#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Keeps the result of every run in a file of its own line (JSON), so that a
 * search that was ended goes on where it was, and another search of the same data does
 * not run what this one ran. */
class TuningStore {
public:
  /** \param[in] path file to go on with, or to begin; empty = keep nothing
   * \param[in] data what the runs are made from, one "name: value" a line; others need
   * another file
   * \param[in] classes L
   * \throws BadInputException if the file is of other data, or damaged; a last line
   * that a killed run left unfinished is dropped
   * \throws OutputException */
  TuningStore(const std::string& path, const std::string& data, int classes);

  /** \brief Null if there is none. */
  const TuningResult* find(const MapperConfig& config,
                           const std::string& sequence) const;

  /** \throws OutputException */
  void add(const MapperConfig& config, const std::string& sequence,
           const TuningResult& result);

  /** \brief Results of runs that were there when the file was opened. */
  std::size_t
  known() const
  {
    return known_;
  }

private:
  using Key = std::pair<std::string, std::string>; // parameters and sequence

  void read(const std::string& data);

  std::string path_;
  int classes_;
  std::map<Key, TuningResult> results_;
  std::size_t known_ = 0;
  std::ofstream stream_;
};

} // namespace pcl_semantic
