// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/drawing.h>

#include <opencv2/imgproc.hpp>

#include <cmath>

namespace pcl_semantic {

namespace {

// Small strokes of OpenCV are ragged, so text is drawn large and reduced.
constexpr int kOversampling = 4;
constexpr double kFontScale = 0.47;

cv::Size
largeTextSize(const std::string& text, double size, int& base_line)
{
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX,
                         kFontScale * size * kOversampling,
                         cvRound(kOversampling * 1.2 * size), &base_line);
}

} // namespace

const DrawingTheme dark_theme{cv::Scalar(24, 24, 24), cv::Scalar(235, 235, 235)};
const DrawingTheme light_theme{cv::Scalar(252, 250, 249), cv::Scalar(50, 44, 40)};

cv::Vec3b
classColour(const LabelSet& label_set, Label label)
{
  const LabelClass& label_class = label_set[label];
  return {label_class.colour[2], label_class.colour[1], label_class.colour[0]};
}

int
textWidth(const std::string& text, double size)
{
  int base_line = 0;
  return largeTextSize(text, size, base_line).width / kOversampling + 1;
}

void
drawText(cv::Mat& picture, const std::string& text, cv::Point at,
         const cv::Scalar& colour, double size)
{
  int base_line = 0;
  const cv::Size large = largeTextSize(text, size, base_line);
  const int margin = cvCeil(3.0 * size); // for the stroke width
  const cv::Size small(large.width / kOversampling + 2 * margin,
                       (large.height + base_line) / kOversampling + 2 * margin);
  const int above = large.height / kOversampling + margin;
  cv::Mat strokes = cv::Mat::zeros(small * kOversampling, CV_8UC1), cover;
  cv::putText(strokes, text, cv::Point(margin, above) * kOversampling,
              cv::FONT_HERSHEY_SIMPLEX, kFontScale * size * kOversampling,
              cv::Scalar::all(255), cvRound(kOversampling * 1.2 * size), cv::LINE_AA);
  cv::resize(strokes, cover, small, 0, 0, cv::INTER_AREA);
  const cv::Rect position(at - cv::Point(margin, above), small);
  const cv::Rect inside = position & cv::Rect(cv::Point(), picture.size());
  for (int v = inside.y; v < inside.y + inside.height; ++v)
    for (int u = inside.x; u < inside.x + inside.width; ++u) {
      const double part =
          cover.at<std::uint8_t>(v - position.y, u - position.x) / 255.0;
      cv::Vec3b& pixel = picture.at<cv::Vec3b>(v, u);
      for (int c = 0; c < 3; ++c)
        pixel[c] =
            cv::saturate_cast<std::uint8_t>(pixel[c] + part * (colour[c] - pixel[c]));
    }
}

namespace {

constexpr int row_height = 24, swatch = 14, gap = 8; // of a legend [px]

std::vector<cv::Point>
placeEntries(const std::vector<LegendEntry>& entries, int width)
{
  std::vector<cv::Point> positions;
  cv::Point at(gap, gap);
  for (const LegendEntry& entry : entries) {
    const int advance = swatch + textWidth(entry.text) + 3 * gap;
    if (at.x > gap && at.x + advance > width)
      at = {gap, at.y + row_height};
    positions.push_back(at);
    at.x += advance;
  }
  return positions;
}

} // namespace

int
rowsOfLegend(const std::vector<LegendEntry>& entries, int width)
{
  const std::vector<cv::Point> positions = placeEntries(entries, width);
  return positions.empty() ? 0 : (positions.back().y - gap) / row_height + 1;
}

cv::Mat
withLegend(const cv::Mat& picture, const std::vector<LegendEntry>& entries,
           const DrawingTheme& theme, int least_rows)
{
  const std::vector<cv::Point> positions = placeEntries(entries, picture.cols);
  const int rows = std::max(least_rows, rowsOfLegend(entries, picture.cols));
  if (rows == 0)
    return picture;
  cv::Mat legend(gap + rows * row_height, picture.cols, CV_8UC3, theme.background);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    cv::rectangle(legend, cv::Rect(positions[i].x, positions[i].y, swatch, swatch),
                  cv::Scalar(entries[i].colour), cv::FILLED);
    drawText(legend, entries[i].text, positions[i] + cv::Point(swatch + 6, swatch - 2),
             theme.text);
  }
  cv::Mat result;
  cv::vconcat(picture, legend, result);
  return result;
}

std::vector<LegendEntry>
legendOf(const LabelSet& label_set, const std::vector<bool>& is_shown)
{
  std::vector<LegendEntry> entries;
  for (int label = 1; label <= label_set.size(); ++label)
    if (is_shown[std::size_t(label)])
      entries.push_back(
          {label_set[Label(label)].name, classColour(label_set, Label(label))});
  return entries;
}

void
drawScale(cv::Mat& picture, double pixels_per_metre, const DrawingTheme& theme)
{
  const double wanted = 0.2 * picture.cols / pixels_per_metre;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  const double metres = power * (wanted / power >= 5.0   ? 5.0
                                 : wanted / power >= 2.0 ? 2.0
                                                         : 1.0);
  const cv::Point left(16, picture.rows - 16);
  const cv::Point right(left.x + cvRound(metres * pixels_per_metre), left.y);
  cv::line(picture, left, right, theme.text, 2);
  for (const cv::Point& end : {left, right})
    cv::line(picture, end - cv::Point(0, 5), end, theme.text, 2);
  drawText(picture, cv::format("%g m", metres), left + cv::Point(6, -7), theme.text);
}

} // namespace pcl_semantic
