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

/** \brief Length of a submap; set one of both. */
struct SubmapLength {
  double metres = 0.0; ///< along the trajectory
  int frames = 0;
};

/** \brief Splits a sequence into submaps.
 * \param[in] positions of the frames, in order [m]
 * \return the first frame of each submap, ascending from 0; empty without frames
 * \throws InvalidParameterException unless exactly one length is positive */
std::vector<std::size_t> submapStarts(const std::vector<Eigen::Vector3d>& positions,
                                      const SubmapLength& length);

/** \brief The poses of a trajectory for frames of a run.
 * \param[in] description of the run, see describeRun()
 * \param[out] doubts if not null: the warnings of readTrajectory() are appended
 * \throws BadInputException if the description has no sensor, or the trajectory cannot
 * be read */
StoredPoses correctedPoses(const std::string& description,
                           const std::string& trajectory,
                           std::vector<std::string>* doubts = nullptr);

/** \brief Motion of a submap under corrected poses: rigid, that of its anchor, the
 * middle frame.
 * \param[in] trajectory path of the corrected poses, in KITTI's or TUM's format, of the
 * same sensor as the submap's poses
 * \param[out] doubts if not null: the warnings of readTrajectory() are appended
 * \return T_new_old, from the world frame of the submap to that of the poses
 * \throws BadInputException if the submap has no frame records, or the trajectory has
 * no pose for the anchor */
Eigen::Isometry3d submapMotion(const MapArchive& submap, const std::string& trajectory,
                               std::vector<std::string>* doubts = nullptr);

/** \brief A submap and the trajectory that places it. */
struct Submap {
  std::string path;         ///< path of its archive
  std::string trajectory{}; ///< see submapMotion(); empty: not moved
  std::uint64_t digest = 0; ///< its archiveDigest(); 0: not computed yet
  /** \brief Cached motion of placed(); if set, the trajectory is not read. */
  std::optional<Eigen::Isometry3d> motion{};

  bool
  operator<(const Submap& other) const
  {
    return path < other.path;
  }
};

/** \brief Places a submap.
 * \param[out] doubts as in submapMotion()
 * \throws as submapMotion() */
PlacedArchive placed(const Submap& submap, std::vector<std::string>* doubts = nullptr);

/** \brief Merges submaps of one or more sequences, see mergeArchives(). In and around
 * voxels that several submaps have hit, the CRF recomputes the labels: the dense model
 * with the parameters of the first submap (by name), unless its run had no CRF.
 * \return number of blocks
 * \throws as mergeArchives() and submapMotion() */
std::uint64_t mergeSubmaps(const std::vector<Submap>& submaps,
                           const std::string& output,
                           const BlockProgress& progress = nullptr);

/** \brief Merges the objects of the submaps of a tiled map, see mergeTiledObjects().
 * \throws as mergeTiledObjects() and submapMotion() */
void mergeTiledObjects(const std::vector<Submap>& submaps, const std::string& index);

/** \brief The submaps that reach each tile. */
using SubmapTiles = std::map<MapTile, std::vector<Submap>>;

/** \brief The tiles that a placed submap reaches.
 * \throws as submapMotion() */
std::vector<MapTile> tilesOf(const Submap& submap);

/** \brief Merges one tile into an archive of its own, as mergeSubmaps() does, with a
 * halo from the neighbouring tiles as wide as the CRF needs.
 *
 * A text file beside the archive records the submaps, their motions and a checksum of
 * the archive. If this text would not change, the tile is not merged again.
 * \param[in] tile a key of \a tiles
 * \param[in] output path, "tiles/0_0.map"; the text is "tiles/0_0.made"
 * \return whether the tile was merged
 * \throws as mergeSubmaps() */
bool mergeTile(const SubmapTiles& tiles, const MapTile& tile,
               const std::string& output);

} // namespace pcl_semantic
