// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic {

using LabelColour = std::array<std::uint8_t, 3>; ///< red, green, blue

/** \brief The colour of a class; white without a label set or label. */
LabelColour colourOf(Label label, const LabelSet& label_set);

/** \brief Coloured lines in space. */
struct PlyLines {
  struct Corner {
    Eigen::Vector3d position; ///< [m]
    LabelColour colour;
  };

  std::vector<Corner> corners;
  std::vector<std::pair<std::size_t, std::size_t>> edges; ///< indices of two corners
};

/** \brief Writes lines as text (.ply).
 * \throws OutputException if the file cannot be written */
void writePlyLines(const std::string& path, const PlyLines& lines);

} // namespace pcl_semantic
