// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stereo_pair_reader.h"

#include <pcl_semantic/files/input_file.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The pairs of two folders that another program fills: PNG images whose names
 * are the same number. */
class NewPairs {
public:
  NewPairs(std::string left, std::string right);

  /** \brief Finds the newest complete pair; a complete PNG ends with its end chunk.
   * \return number of new pairs; 0 = none
   * \throws BadInputException if the left folder cannot be read */
  int next(StereoPairFiles& pair);

private:
  std::string rightOf(const FrameFile& left) const;

  void look();

  bool isBehind(const std::filesystem::path& path);

  std::string left_, right_;
  std::vector<FrameFile> found_; // left images after last_, by number
  int passed_ = 0;               // older unchecked or late ones
  int behind_ = 0;               // counted files up to last_
  int last_ = -1;                // number of the last returned pair
  std::filesystem::file_time_type seen_ = std::filesystem::file_time_type::min();
};

} // namespace pcl_semantic
