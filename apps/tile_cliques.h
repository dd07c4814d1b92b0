// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/clouds/labelled_cloud.h>

#include <pcl/PointIndices.h>

#include <cstddef>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Gives a generator the mean positions of a map's voxels; before
 * moveToVoxelCentres(). */
void setMeanPositions(const LabelledCloud& cloud, CliqueGenerator& generator);

/** \brief Makes the cliques of a cloud. */
std::vector<pcl::PointIndices> cliquesOf(const LabelledCloud& cloud,
                                         CliqueGenerator& generator);

/** \brief Points of a clique that are in a tile, whose points are the first \a own. */
std::size_t countOwn(const pcl::PointIndices& clique, std::size_t own);

/** \brief Numbers of the cliques of a tile and its surroundings. */
struct CliqueCounts {
  std::size_t of_tile = 0; ///< with points of the tile
  std::size_t cut = 0;     ///< of these, with points around it
};

/** \param[in] own points of the tile, the first ones */
CliqueCounts countCliques(const std::vector<pcl::PointIndices>& cliques,
                          std::size_t own);

} // namespace pcl_semantic::tool
