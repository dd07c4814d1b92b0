// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/pipeline/run_description.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Keeps a run in a map archive, so that it can be killed at any moment and go
 * on; without a path it keeps nothing.
 *
 * A commit holds all that the rest of the run depends on: the map with its window, its
 * origin, and the frames that are in it. A run that goes on maps the frames after the
 * last commit (again), and ends with the map that it would have made at one go. */
class MappingArchive {
public:
  struct Options {
    std::string path;    ///< of the archive; empty = none
    int every = 10;      ///< a commit every so many frames
    bool resume = false; ///< go on with what is there; begin if nothing is
  };

  /** \throws InvalidParameterException if options make no sense
   * \throws BadInputException if the archive is of another run: names what differs
   * \throws OutputException if it cannot be written, or is there and not resumed */
  MappingArchive(const Options& options, const MappingRun& run);

  /** \brief Removes an archive that it made and that holds no frame: a run that failed
   * at once can be begun again. */
  ~MappingArchive();

  /** \brief For SemanticMapper; null without an archive. */
  std::shared_ptr<BlockStore> store() const;

  /** \brief Takes the mapper to where the archive left it. */
  void resume(SemanticMapper& mapper) const;

  /** \brief Of the frames that the archive held already. */
  const std::vector<FrameRecord>&
  records() const
  {
    return records_;
  }

  /** \brief After each frame: commits, if it is time. */
  void add(const SensorFrame& frame, const MappedFrame& mapped, SemanticMapper& mapper);

  /** \brief After the last frame, or an interrupt: ends the map and commits. A live
   * run, whose frames are not known before, ends where it is interrupted. */
  void finish(SemanticMapper& mapper);

  /** \brief After an error: likewise, but the archive says that it is not finished. */
  void abandon(SemanticMapper& mapper);

  /** \brief When nothing is read from the map any more: brings the archive into one
   * file. \return false if another program kept reading it: FILE-wal then belongs to it
   */
  bool close();

private:
  void commit(SemanticMapper& mapper, bool finished);

  Options options_;
  std::shared_ptr<MapArchive> archive_;
  std::vector<FrameRecord> records_; // that were in the archive
  int last_frame_ = -1;              // of the run
  int added_frame_ = -1;
  int since_commit_ = 0;
  bool is_new_ = false;
};

} // namespace pcl_semantic
