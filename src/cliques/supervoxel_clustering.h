// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/cliques/supervoxel_cliques.h>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Supervoxels of the points in a cube [0, edge)^3, edge an even number of
 * voxels. The one place that sees pcl::SupervoxelClustering.
 * \param[in] cloud finite points of the cube [m]
 * \param[in] voxels edge of the cube in voxels
 * \return one label a point, 0 = none */
std::vector<std::uint32_t> clusterSupervoxels(const CliqueGenerator::Cloud& cloud,
                                              const SupervoxelParameters& parameters,
                                              int voxels);

/** \brief Gives the points without a label that of the nearest point with one, if it is
 * within \a reach [m]. */
void labelTheRest(const CliqueGenerator::Cloud& cloud, double reach,
                  std::vector<std::uint32_t>& labels);

} // namespace pcl_semantic
