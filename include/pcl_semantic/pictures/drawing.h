// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Colours of background and annotations. */
struct DrawingTheme {
  cv::Scalar background;
  cv::Scalar text;
};

extern const DrawingTheme dark_theme;
extern const DrawingTheme light_theme;

struct LegendEntry {
  std::string text;
  cv::Vec3b colour; ///< blue, green, red
};

/** \brief The colour of a class (blue, green, red). */
cv::Vec3b classColour(const LabelSet& label_set, Label label);

/** \brief Width of a text as drawText() draws it [px]. */
int textWidth(const std::string& text, double size = 1.0);

/** \brief Draws a line of ASCII text.
 * \param[in] at left end of the baseline
 * \param[in] size 1: letters 10 px high */
void drawText(cv::Mat& picture, const std::string& text, cv::Point at,
              const cv::Scalar& colour, double size = 1.0);

/** \brief Adds a legend below an image, in as many rows as the width requires.
 * \param[in] least_rows height of the legend, if it needs fewer rows */
cv::Mat withLegend(const cv::Mat& picture, const std::vector<LegendEntry>& entries,
                   const DrawingTheme& theme, int least_rows = 0);

/** \brief One entry per class that is shown, in the order of the labels.
 * \param[in] is_shown by label, 256 */
std::vector<LegendEntry> legendOf(const LabelSet& label_set,
                                  const std::vector<bool>& is_shown);

/** \brief Rows of a legend. \param[in] width of the image [px] */
int rowsOfLegend(const std::vector<LegendEntry>& entries, int width);

/** \brief Draws a scale bar of 1, 2 or 5 times a power of ten metres in the lower left
 * corner. */
void drawScale(cv::Mat& picture, double pixels_per_metre, const DrawingTheme& theme);

} // namespace pcl_semantic
