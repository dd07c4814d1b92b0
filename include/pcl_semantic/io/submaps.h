// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/stored_poses.h>
#include <pcl_semantic/io/archive_merge.h>
#include <pcl_semantic/io/map_archive.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How much of a drive goes into a submap: one of both. */
struct SubmapLength {
  double metres = 0.0; ///< of the way that was driven
  int frames = 0;
};

/** \brief Where submaps begin.
 * \param[in] positions of the frames of a drive, in order [m]
 * \return the first frame of each submap, rising, the first is 0; empty without frames
 * \throws InvalidParameterException unless one of both lengths is positive */
std::vector<std::size_t> submapStarts(const std::vector<Eigen::Vector3d>& positions,
                                      const SubmapLength& length);

/** \brief The poses of a trajectory, for frames of a run.
 * \param[in] description of the run, see describeRun()
 * \param[out] doubts if not null: those of readTrajectory() are added to it
 * \throws BadInputException */
StoredPoses correctedPoses(const std::string& description,
                           const std::string& trajectory,
                           std::vector<std::string>* doubts = nullptr);

/** \brief How corrected poses move a submap: rigidly, as they move its anchor, which is
 * the middle one of its frames.
 * \param[in] trajectory path of the poses, KITTI's or TUM's, of what the poses were of
 * that the submap was made with
 * \param[out] doubts if not null: those of readTrajectory() are added to it
 * \return T_new_old, from the world frame of the submap to that of the poses
 * \throws BadInputException if the submap does not hold the frames it was made of, or
 * the trajectory has no pose for the anchor */
Eigen::Isometry3d submapMotion(const MapArchive& submap, const std::string& trajectory,
                               std::vector<std::string>* doubts = nullptr);

/** \brief A submap, and what places it. */
struct Submap {
  std::string path;         ///< of its archive
  std::string trajectory{}; ///< see submapMotion(); empty: it lies where it was made
  std::uint64_t digest = 0; ///< archiveDigest() of it; 0: not computed yet
  /** \brief Of placed(), if it was computed already; the trajectory is not read then.
   */
  std::optional<Eigen::Isometry3d> motion{};

  bool
  operator<(const Submap& other) const
  {
    return path < other.path;
  }
};

/** \brief A submap where it belongs. \param[out] doubts as of submapMotion()
 * \throws as submapMotion() */
PlacedArchive placed(const Submap& submap, std::vector<std::string>* doubts = nullptr);

/** \brief Joins submaps of one drive or of several, see mergeArchives(). Where more
 * than one has hit a voxel, and around it, the CRF says anew what it is: the dense
 * model with the parameters of the run of the first by name, unless that run had none.
 * \return number of blocks
 * \throws as mergeArchives() and submapMotion() */
std::uint64_t mergeSubmaps(const std::vector<Submap>& submaps,
                           const std::string& output,
                           const BlockProgress& progress = nullptr);

/** \brief The tiles that submaps reach, by tile: which of them. */
using SubmapTiles = std::map<MapTile, std::vector<Submap>>;

/** \brief The tiles that a submap reaches where it is placed.
 * \throws as submapMotion() */
std::vector<MapTile> tilesOf(const Submap& submap);

/** \brief Merges one tile into an archive of its own, as mergeSubmaps() does; a halo as
 * wide as the CRF needs comes from the tiles around it.
 * \param[in] tile a key of \a tiles
 *
 * Beside it a text says from which submaps it was made, how they were placed, and what
 * its own bytes are. A tile whose text would be the same is left as it is.
 * \param[in] output path, "tiles/0_0.map"; the text is "tiles/0_0.made"
 * \return whether it was made now \throws as mergeSubmaps() */
bool mergeTile(const SubmapTiles& tiles, const MapTile& tile,
               const std::string& output);

} // namespace pcl_semantic
