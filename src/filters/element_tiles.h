// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>
#include <pcl/types.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A part of some elements: columns of their positions. */
struct ElementTile {
  pcl::Indices own;  ///< each element is in one tile
  pcl::Indices halo; ///< elements of other tiles within the reach of its box
};

/** \brief Limits of the tiles of a division. */
struct TileLimits {
  double reach = 0.0;   ///< width of the halo, in the unit of the positions
  std::size_t most = 1; ///< elements in a tile, or in a tile and its halo
  bool is_most_with_halo = false;
  /// Extent up to which a tile (without its halo) is not divided at a gap.
  double widest = HUGE_VAL;
  /// Largest share of a tile and its halo that its parts may need in the mean;
  /// otherwise it is not divided.
  double worthwhile = 0.75;
};

/** \brief Boxes that divide space. A box that is too wide or has too many elements is
 * divided across its longest axis. Elements of equal coordinates stay together, so the
 * boxes do not depend on the order of the elements. */
class TileBoxes {
public:
  using Visit = std::function<void(const ElementTile&)>;

  /** \param[in] positions 1 to 3 rows x n, finite
   * \param[in] visit is called with the elements of each box; may be null */
  TileBoxes(const Eigen::MatrixXf& positions, const TileLimits& limits,
            const Visit& visit = nullptr);

  /** \brief Number of boxes, at least 1. */
  std::size_t
  size() const
  {
    return boxes_;
  }

  /** \brief The box of any position. */
  std::size_t boxOf(const Eigen::Vector3f& position) const;

  /** \brief Calls \a visit with each box within the reach of a position, its own
   * included. */
  template <typename VisitBox>
  void
  forEachNear(const Eigen::Vector3f& position, const VisitBox& visit) const
  {
    descend(0, position, visit);
  }

private:
  // Half of space, or a box.
  struct Node {
    Eigen::Index axis = 0;
    float middle = 0.0f;       // smaller coordinates are on the left
    int left = -1, right = -1; // nodes; -1: this is a box
    std::size_t box = 0;
  };

  template <typename VisitBox>
  void
  descend(int at, const Eigen::Vector3f& position, const VisitBox& visit) const
  {
    const Node& node = nodes_[std::size_t(at)];
    if (node.left < 0)
      return visit(node.box);
    // Rounds outward: halos are computed in single precision.
    const double reach = double(reach_) * (1.0 + 1e-6);
    const double offset = double(position[node.axis]) - double(node.middle);
    if (offset <= reach)
      descend(node.left, position, visit);
    if (offset >= -reach)
      descend(node.right, position, visit);
  }

  int divide(const Eigen::MatrixXf& positions, ElementTile tile, const Visit& visit);

  int addBox(const ElementTile& tile, const Visit& visit);

  pcl::Indices haloOf(const Eigen::MatrixXf& positions, const pcl::Indices& own,
                      const pcl::Indices& other, const pcl::Indices& halo) const;

  bool isSmall(const ElementTile& tile) const;

  std::size_t leftSize(std::size_t size) const;

  TileLimits limits_;
  float reach_;
  std::vector<Node> nodes_;
  std::size_t boxes_ = 0;
};

/** \brief Calls a function with the tile of each box of TileBoxes; the parameters are
 * the same. */
void forEachTile(const Eigen::MatrixXf& positions, const TileLimits& limits,
                 const TileBoxes::Visit& visit);

} // namespace pcl_semantic
