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

/** \brief Stores a run in a map archive, so that a killed run can be resumed. Without a
 * path it stores nothing.
 *
 * A commit contains everything that the rest of the run depends on: the map with its
 * window and origin, and its frames. A resumed run maps the frames after the last
 * commit (again), and its map is identical to that of an uninterrupted run. */
class MappingArchive {
public:
  struct Options {
    std::string path;    ///< path of the archive; empty = none
    int every = 10;      ///< frames per commit
    bool resume = false; ///< resume an existing run, or begin a new one
  };

  /** \throws InvalidParameterException if options contradict each other
   * \throws BadInputException that names the difference, if the archive is of another
   * run
   * \throws OutputException if it cannot be written, or exists and is not resumed */
  MappingArchive(const Options& options, const MappingRun& run);

  /** \brief Removes a new archive without frames, so that a run that failed at its
   * start can be repeated. */
  ~MappingArchive();

  /** \brief For SemanticMapper; null without an archive. */
  std::shared_ptr<BlockStore> store() const;

  /** \brief Restores the state of the mapper from the archive. */
  void resume(SemanticMapper& mapper) const;

  /** \brief Records of the frames in the archive before the run. */
  const std::vector<FrameRecord>&
  records() const
  {
    return records_;
  }

  /** \brief Adds a frame after mapping; commits at the set interval. */
  void add(const SensorFrame& frame, const MappedFrame& mapped, SemanticMapper& mapper);

  /** \brief After the last frame or an interrupt: finishes the map and commits. For a
   * live run, whose length is unknown, an interrupt is its regular end. */
  void finish(SemanticMapper& mapper);

  /** \brief After an error: like finish(), but the archive is marked as unfinished. */
  void abandon(SemanticMapper& mapper);

  /** \brief Merges SQLite's log into the archive, after the last read of the map.
   * \return false if another program still reads the archive and keeps FILE-wal */
  bool close();

private:
  void commit(SemanticMapper& mapper, bool finished);

  Options options_;
  std::shared_ptr<MapArchive> archive_;
  std::vector<FrameRecord> records_; // records in the archive before the run
  int last_frame_ = -1;              // of the run
  int added_frame_ = -1;
  int since_commit_ = 0;
  bool is_new_ = false;
};

} // namespace pcl_semantic
