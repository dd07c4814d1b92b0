// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Manages the output folder of a run, including the replacement of an earlier
 * run. */
struct RunFolder {
  /** \brief Folders written at each frame; final_labels is written at the end. */
  static constexpr const char* frame_folders[] = {"labels", "labels_at_depth",
                                                  "network_labels", "overlay"};

  static constexpr const char* map_files[] = {
      "map.pcd",   "map_classes.pcd", "label_set.yaml", "top_view.png",  "objects.json",
      "boxes.ply", "planes.json",     "planes.ply",     "trajectory.txt"};

  /** \brief The current map during a run, a separate map folder. */
  static constexpr const char* live = "live";

  /** \brief The previous finished map, until the new one is complete. */
  static constexpr const char* previous = "previous";

  /** \brief All names of files and folders that a run may write. */
  static const std::vector<std::string>& names();

  /** \brief Whether a file is the summary of a run, finished or not. */
  static bool isSummary(const std::string& path);

  /** \brief Checks before a run that a finished map can be moved to `previous`.
   * \throws OutputException if `previous` was not made by a run */
  static void requireRoom(const std::string& folder);

  /** \brief Prepares the folder for a run. Moves a finished map to `previous`, removes
   * the output of an unfinished run, and writes a summary that marks the run as
   * unfinished. Other files are kept, and so is a finished map of the same run, with
   * the same frames.
   *
   * \param[in] kept frames of a resumed run, in order, whose images are kept
   * \param[in] has_images whether the run writes images
   *
   * \throws OutputException */
  static void beginRun(const std::string& folder, const std::vector<int>& kept,
                       bool has_images);

  /** \brief Removes `live` after the new map was written and, if the map is complete,
   * `previous` if a run moved it there. */
  static void endRun(const std::string& folder, bool is_whole);
};

} // namespace pcl_semantic
