// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/evaluation_report.h>

#include <opencv2/imgproc.hpp>

#include <cstdio>

namespace pcl_semantic {

namespace {

constexpr int cell_width = 62;  ///< [px]
constexpr int cell_height = 34; ///< [px]
constexpr int left_margin = 130;
constexpr int top_margin = 120;
constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
constexpr double font_scale = 0.45;
const cv::Scalar black(0, 0, 0), grey(160, 160, 160), white(255, 255, 255);

/** \brief One line of text, as an image of its own, so that it can be turned. */
cv::Mat
textImage(const std::string& text, const cv::Scalar& ink, const cv::Scalar& paper)
{
  int below = 0;
  const cv::Size size = cv::getTextSize(text, font, font_scale, 1, &below);
  cv::Mat image(size.height + below + 2, size.width + 2, CV_8UC3, paper);
  cv::putText(image, text, {1, size.height + 1}, font, font_scale, ink, 1, cv::LINE_AA);
  return image;
}

/** \brief Puts an image into another with \a x, \a y as its middle; what does not fit
 * is cut off. */
void
paste(const cv::Mat& image, cv::Mat& canvas, int x, int y)
{
  const cv::Rect place(x - image.cols / 2, y - image.rows / 2, image.cols, image.rows);
  const cv::Rect visible = place & cv::Rect({0, 0}, canvas.size());
  if (!visible.empty())
    image(visible - place.tl()).copyTo(canvas(visible));
}

cv::Scalar
colourOf(const LabelClass& entry)
{
  return {double(entry.colour[2]), double(entry.colour[1]), double(entry.colour[0])};
}

/** \brief A share from white to dark blue, its percentage in it. */
void
drawCell(cv::Mat& canvas, const cv::Rect& place, double share)
{
  const cv::Scalar paper =
      white * (1.0 - share) + cv::Scalar(130.0, 60.0, 10.0) * share;
  cv::rectangle(canvas, place, paper, cv::FILLED);
  cv::rectangle(canvas, place, grey);
  char text[16];
  std::snprintf(text, sizeof(text), "%.1f", 100.0 * share);
  if (share > 0.0)
    paste(textImage(text, share > 0.5 ? white : black, paper), canvas,
          place.x + place.width / 2, place.y + place.height / 2);
}

/** \brief Shares of a true class: predicted as the evaluated ones, uncovered, other. */
std::vector<double>
rowShares(const ConfusionMatrix& confusion, Label truth,
          const std::vector<Label>& evaluated)
{
  std::uint64_t total = 0, named = 0;
  for (int prediction = 0; prediction <= confusion.classes(); ++prediction)
    total += confusion(truth, static_cast<Label>(prediction));
  std::vector<double> shares;
  std::vector<Label> columns = evaluated;
  columns.push_back(kUnlabelled);
  for (const Label prediction : columns) {
    named += confusion(truth, prediction);
    shares.push_back(total ? double(confusion(truth, prediction)) / double(total)
                           : 0.0);
  }
  shares.push_back(total ? double(total - named) / double(total) : 0.0);
  return shares;
}

} // namespace

cv::Mat
drawConfusion(const ConfusionMatrix& confusion, const LabelSet& label_set,
              const std::vector<Label>& evaluated)
{
  const int rows = static_cast<int>(evaluated.size()), columns = rows + 2;
  cv::Mat canvas(top_margin + rows * cell_height + 12,
                 left_margin + columns * cell_width + 12, CV_8UC3, white);
  paste(textImage("truth \\ prediction [%]", black, white), canvas, 90, 16);
  for (int column = 0; column < columns; ++column) {
    const bool named = column < rows;
    const std::string name = named            ? label_set[evaluated[column]].name
                             : column == rows ? "uncovered"
                                              : "other";
    cv::Mat text;
    cv::rotate(textImage(name, black, white), text, cv::ROTATE_90_COUNTERCLOCKWISE);
    const int x = left_margin + column * cell_width + cell_width / 2;
    paste(text, canvas, x, top_margin - 22 - text.rows / 2);
    if (named)
      cv::rectangle(canvas, {x - 8, top_margin - 16, 16, 10},
                    colourOf(label_set[evaluated[column]]), cv::FILLED);
  }
  for (int row = 0; row < rows; ++row) {
    const int y = top_margin + row * cell_height;
    const LabelClass& entry = label_set[evaluated[row]];
    const cv::Mat text = textImage(entry.name, black, white);
    paste(text, canvas, left_margin - 26 - text.cols / 2, y + cell_height / 2);
    cv::rectangle(canvas, {left_margin - 18, y + cell_height / 2 - 6, 12, 12},
                  colourOf(entry), cv::FILLED);
    const std::vector<double> shares = rowShares(confusion, evaluated[row], evaluated);
    for (int column = 0; column < columns; ++column)
      drawCell(canvas, {left_margin + column * cell_width, y, cell_width, cell_height},
               shares[column]);
  }
  return canvas;
}

} // namespace pcl_semantic
