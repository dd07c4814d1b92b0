// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <opencv2/core/mat.hpp>

namespace pcl_semantic::tool {

constexpr int kPanelWidth = 270; ///< [px]

/** \brief The panel beside a map: legend, limits, keys. */
struct ViewPanel {
  cv::Mat picture; ///< CV_8UC3 (BGR)

  /** \brief A row of the panel that toggles a class. */
  struct Row {
    int top = 0, bottom = 0; ///< [px]
    Label label = kUnlabelled;
  };
  std::vector<Row> rows;
};

/** \brief Draws the panel. \param[in] max_rows height limit in pixels */
ViewPanel drawPanel(const ViewedMap& map, const ViewState& state, int max_rows);

} // namespace pcl_semantic::tool
