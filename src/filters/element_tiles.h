// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>
#include <pcl/types.h>

#include <cstddef>
#include <functional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A part of some elements: columns of their positions. */
struct ElementTile {
  pcl::Indices own;  ///< each element is in one tile
  pcl::Indices halo; ///< elements of other tiles within the reach of its box
};

/** \brief Divides elements into boxes, at the median of the longest axis, until a box
 * has at most a number of elements, or its halves would need more than 75 % of the
 * elements of it and its halo. Elements of equal coordinates stay together, so the
 * tiles do not depend on the order of the elements.
 * \param[in] positions 1 to 3 rows x n, finite
 * \param[in] reach width of the halo, in the unit of the positions
 * \param[in] most elements in a tile, more than 0
 * \param[in] visit is called with each tile */
void forEachTile(const Eigen::MatrixXf& positions, double reach, std::size_t most,
                 const std::function<void(const ElementTile&)>& visit);

} // namespace pcl_semantic
