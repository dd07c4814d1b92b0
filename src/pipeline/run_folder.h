// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief The folder that a run writes to: what lies there, and how one run takes the
 * place of another. */
struct RunFolder {
  /** \brief Written at each frame, beside final_labels at the end. */
  static constexpr const char* frame_folders[] = {"labels", "labels_at_depth",
                                                  "network_labels", "overlay"};

  static constexpr const char* map_files[] = {
      "map.pcd", "map_classes.pcd", "label_set.yaml", "top_view.png", "trajectory.txt"};

  /** \brief The map as it is while it is made, a map folder of its own. */
  static constexpr const char* live = "live";

  /** \brief The finished map that was there before, until the new one is whole. */
  static constexpr const char* previous = "previous";

  /** \brief All names of files and folders that any run may write. */
  static const std::vector<std::string>& names();

  /** \brief Whether a file is the summary of a run of ours, finished or not. */
  static bool isSummary(const std::string& path);

  /** \brief Before a run: makes sure that a finished map can be set aside.
   * \throws OutputException if `previous` is not of a run */
  static void requireRoom(const std::string& folder);

  /** \brief Makes room for the frames of a run: a finished map that lies there is moved
   * to `previous`, what an unfinished run has left is removed, and a summary says that
   * the new one is not finished. Files of others stay, and so does the finished map of
   * this very run, whose frames are all kept.
   *
   * \param[in] kept frames, in order, that the run has mapped before, whose images stay
   * \param[in] has_images whether it writes images
   *
   * \throws OutputException */
  static void beginRun(const std::string& folder, const std::vector<int>& kept,
                       bool has_images);

  /** \brief Once the new map is written: removes `live` and, if the map is whole,
   * `previous` if it was set aside. */
  static void endRun(const std::string& folder, bool is_whole);
};

} // namespace pcl_semantic
