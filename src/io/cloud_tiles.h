// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cloud_survey.h"
#include "files/row_store.h"
#include "filters/element_tiles.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A part of a cloud and its surroundings. */
struct CloudTile {
  PcdTable table;                     ///< the tile's points first, then those around it
  std::vector<std::uint64_t> numbers; ///< of the tile's points in the file, ascending
};

struct TileOptions {
  double reach = 0.0;         ///< width of the surroundings [m]
  std::size_t most = 1000000; ///< points in a tile and its surroundings, about
  double voxel_size = 0.0;    ///< voxels that tiles do not cut [m]; 0 = none
};

/** \brief A binary `.pcd` file, divided into boxes on disk (TileBoxes). */
class CloudTiles {
public:
  /** \param[in] folder that has room for the points
   * \param[in] step is called after each block of the file
   * \throws OutputException if the folder has no room */
  CloudTiles(PcdReader& reader, const CloudSurvey& survey, const TileOptions& options,
             const std::string& folder, const std::function<void()>& step);

  std::size_t
  size() const
  {
    return boxes_.size();
  }

  CloudTile read(std::size_t tile) const;

  /** \brief Points around the tiles for each point of the cloud. */
  double
  shareAround() const
  {
    return double(around_) / double(std::max<std::size_t>(points_, 1));
  }

private:
  PcdTable header_;
  TileBoxes boxes_;
  RowStore store_;
  std::size_t points_ = 0, around_ = 0;
};

} // namespace pcl_semantic
