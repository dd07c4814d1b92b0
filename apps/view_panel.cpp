// SPDX-License-Identifier: BSD-3-Clause
#include "view_panel.h"

#include <pcl_semantic/pictures/drawing.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic::tool {

namespace {

constexpr int kRow = 20, kMargin = 10, kSwatch = 13;
constexpr double kLetters = 0.86;
const cv::Scalar pale(170, 166, 164);

// Writes rows below each other, while there is space.
class PanelWriter {
public:
  explicit PanelWriter(int max_rows)
      : picture_(std::max(max_rows, 2 * kRow), kPanelWidth, CV_8UC3,
                 light_theme.background)
  {}

  void
  line(const std::string& text, const cv::Scalar& colour = light_theme.text)
  {
    // Reduces text that is too wide.
    const double size = std::min(kLetters, kLetters * (kPanelWidth - 2 * kMargin) /
                                               textWidth(text, kLetters));
    if (hasRoom())
      drawText(picture_, text, {kMargin, bottom_ + kRow - 6}, colour, size);
    bottom_ += kRow;
  }

  void
  swatch(const std::string& key, const std::string& text, const cv::Vec3b& colour,
         bool is_hidden)
  {
    if (hasRoom()) {
      const cv::Scalar ink = is_hidden ? pale : light_theme.text;
      drawText(picture_, key, {kMargin, bottom_ + kRow - 6}, pale, kLetters);
      const cv::Rect position(kMargin + 16, bottom_ + 3, kSwatch, kSwatch);
      cv::rectangle(picture_, position, cv::Scalar(colour), is_hidden ? 1 : cv::FILLED);
      drawText(picture_, text, {position.x + kSwatch + 8, bottom_ + kRow - 6}, ink,
               kLetters);
    }
    bottom_ += kRow;
  }

  void
  gap()
  {
    bottom_ += kRow / 3;
  }

  void
  image(const cv::Mat& image)
  {
    cv::Mat small;
    cv::resize(image, small, {kPanelWidth, image.rows * kPanelWidth / image.cols}, 0, 0,
               cv::INTER_AREA);
    if (bottom_ + small.rows < picture_.rows)
      small.copyTo(picture_(cv::Rect(cv::Point(0, bottom_), small.size())));
    bottom_ += small.rows;
  }

  int
  bottom() const
  {
    return bottom_;
  }

  bool
  hasRoom() const
  {
    return bottom_ + kRow <= picture_.rows;
  }

  cv::Mat
  finish()
  {
    const int rows = std::min(bottom_ + kMargin / 2, picture_.rows);
    return picture_.rowRange(0, rows).clone();
  }

private:
  cv::Mat picture_;
  int bottom_ = kMargin / 2;
};

} // namespace

ViewPanel
drawPanel(const ViewedMap& map, const ViewState& state, int max_rows)
{
  PanelWriter writer(max_rows);
  ViewPanel panel;
  const Colouring& colouring = map.colourings[state.colouring];
  if (map.pictures.size() == 1)
    writer.image(map.pictures[0].image);
  writer.line(map.title + ": " + colouring.name);
  writer.line(colouring.colours.note);
  if (std::isfinite(state.below))
    writer.line(cv::format("heights below %.2f m", state.below));
  if (state.selected)
    writer.line(map.objects[*state.selected].text);
  writer.gap();
  for (std::size_t i = 0; i < map.classes.size() && writer.hasRoom(); ++i) {
    const ViewedClass& each = map.classes[i];
    const int top = writer.bottom();
    writer.swatch(keyOf(each.label), each.entry.text, each.entry.colour,
                  state.hidden.count(each.label) > 0);
    panel.rows.push_back({top, writer.bottom(), each.label});
  }
  writer.gap();
  for (const LegendEntry& entry : colouring.colours.legend)
    writer.swatch("", entry.text, entry.colour, false);
  if (state.help)
    for (const std::string& line : helpOnKeys())
      writer.line(line);
  else
    writer.line("h: help", pale);
  panel.picture = writer.finish();
  return panel;
}

} // namespace pcl_semantic::tool
