// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/pose_doubts.h>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The files of a recording of an RGB-D camera. */
struct RgbdLayout {
  struct Files {
    std::string name, colour, depth;
    std::string pose;  ///< file of its pose; may be missing; empty = none
    double time = 0.0; // [s]
    int number = 0;
  };

  std::vector<Files> frames;
  bool is_tum = false;    ///< with lists of times
  bool has_times = false; ///< otherwise frames count as 0.1 s apart
  /// Path of the trajectory in the folder, or of the folder of the pose files; empty =
  /// none.
  std::string poses;
  PoseFrame pose_frame = PoseFrame::camera;
  std::vector<std::string> doubts{};
};

/** \brief Finds the files of a recording; see RgbdSequence for the layouts.
 * \param[in] depth_within between the times of colour and depth in TUM's layout [s]
 * \throws BadInputException if the folder has none of the layouts, or no frame */
RgbdLayout rgbdLayoutOf(const std::string& folder, double depth_within);

} // namespace pcl_semantic
