// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/tuning_report.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pcl_semantic {

namespace {

constexpr int panel_width = 420, panel_height = 300;     // [px]
constexpr int left = 62, right = 18, top = 52, low = 46; // margins of a panel [px]
constexpr int legend_height = 44;
const cv::Scalar black(40, 40, 40), grey(215, 215, 215);
const cv::Scalar all_colour(190, 110, 20), held_out_colour(30, 120, 235); // BGR

struct Curve {
  std::vector<double> all, held_out; // scores; NaN = none
};

std::vector<Curve>
curvesOf(const Tuner& tuner)
{
  const std::map<TuningChoice, double> scores = tuner.scores();
  std::vector<Curve> curves;
  for (std::size_t axis = 0; axis < tuner.grid().axes.size(); ++axis) {
    Curve curve;
    TuningChoice choice = tuner.chosen();
    for (choice[axis] = 0; choice[axis] < tuner.grid().axes[axis].candidates.size();
         ++choice[axis]) {
      const auto found = scores.find(choice);
      curve.all.push_back(found == scores.end() ? NAN : found->second);
      curve.held_out.push_back(
          tuner.options().score(tuner.heldOut(axis, choice[axis])));
    }
    curves.push_back(curve);
  }
  return curves;
}

// The same scale for all panels, so that they can be compared.
std::pair<double, double>
rangeOf(const std::vector<Curve>& curves, double start, double held_out)
{
  double lowest = std::min(start, held_out), highest = std::max(start, held_out);
  for (const Curve& curve : curves)
    for (const auto* values : {&curve.all, &curve.held_out})
      for (const double value : *values)
        if (std::isfinite(value)) {
          lowest = std::min(lowest, value);
          highest = std::max(highest, value);
        }
  const double margin = std::max(0.1, 0.08 * (highest - lowest));
  return {lowest - margin, highest + margin};
}

void
write(cv::Mat& picture, const std::string& text, const cv::Point& centre, double size,
      const cv::Scalar& colour = black)
{
  int below = 0;
  const cv::Size extent =
      cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &below);
  cv::putText(picture, text, centre + cv::Point(-extent.width / 2, extent.height / 2),
              cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

std::string
shortNumber(double value, int digits)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

// One panel: places of candidates, not their values, are the horizontal axis.
class Panel {
public:
  Panel(cv::Mat picture, std::size_t candidates, std::pair<double, double> range)
      : picture_(std::move(picture)), candidates_(candidates), range_(range)
  {}

  void
  drawFrame(const TuningAxis& axis, std::size_t chosen)
  {
    write(picture_, axis.name, {(left + panel_width - right) / 2, 26}, 0.55);
    const double span = range_.second - range_.first;
    const double power = std::pow(10.0, std::floor(std::log10(span / 4.0)));
    const double step = power * (span / 4.0 / power >= 5.0   ? 5.0
                                 : span / 4.0 / power >= 2.0 ? 2.0
                                                             : 1.0);
    for (double value = std::ceil(range_.first / step) * step; value <= range_.second;
         value += step) {
      const cv::Point point = place(0, value);
      cv::line(picture_, {left, point.y}, {panel_width - right, point.y}, grey, 1);
      write(picture_, shortNumber(value, step < 1.0 ? 1 + (step < 0.1) : 0),
            {left / 2, point.y}, 0.42);
    }
    for (std::size_t i = 0; i < candidates_; ++i) {
      const int x = place(i, range_.first).x;
      const int bottom = panel_height - low;
      cv::line(picture_, {x, bottom}, {x, bottom + 4}, black, 1);
      write(picture_, axis.candidates[i], {x, bottom + 16}, 0.42);
      if (i == axis.start)
        write(picture_, "start", {x, bottom + 34}, 0.38);
      if (i == chosen)
        cv::line(picture_, {x, top}, {x, bottom}, cv::Scalar(120, 170, 120), 2);
    }
    cv::rectangle(picture_, cv::Point(left, top),
                  cv::Point(panel_width - right, panel_height - low), black, 1);
  }

  void
  drawLevel(double value, const cv::Scalar& colour)
  {
    const int row = place(0, value).y;
    for (int x = left + 2; x < panel_width - right; x += 10)
      cv::line(picture_, {x, row}, {x + 4, row}, colour, 1);
  }

  void
  drawCurve(const std::vector<double>& values, bool joined, const cv::Scalar& colour,
            int width)
  {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        continue;
      if (joined && i > 0 && std::isfinite(values[i - 1]))
        cv::line(picture_, place(i - 1, values[i - 1]), place(i, values[i]), colour,
                 width, cv::LINE_AA);
      cv::circle(picture_, place(i, values[i]), 2 + width, colour, cv::FILLED,
                 cv::LINE_AA);
    }
  }

private:
  cv::Point
  place(std::size_t candidate, double value) const
  {
    const double x = (double(candidate) + 0.5) / double(candidates_);
    const double y = (value - range_.first) / (range_.second - range_.first);
    return {left + cvRound(x * (panel_width - left - right)),
            panel_height - low - cvRound(y * (panel_height - top - low))};
  }

  cv::Mat picture_;
  std::size_t candidates_;
  std::pair<double, double> range_;
};

void
drawLegend(cv::Mat& picture, const std::string& score)
{
  const auto entry = [&](int x, const cv::Scalar& colour, const std::string& text) {
    cv::circle(picture, {x, legend_height / 2}, 5, colour, cv::FILLED, cv::LINE_AA);
    cv::putText(picture, text, {x + 12, legend_height / 2 + 5},
                cv::FONT_HERSHEY_SIMPLEX, 0.48, black, 1, cv::LINE_AA);
  };
  entry(24, all_colour, "all sequences");
  entry(174, held_out_colour, "held out");
  entry(280, {120, 170, 120}, "chosen");
  entry(370, black, "start");
  cv::putText(picture, score, {448, legend_height / 2 + 5}, cv::FONT_HERSHEY_SIMPLEX,
              0.44, black, 1, cv::LINE_AA);
}

} // namespace

cv::Mat
drawSensitivity(const Tuner& tuner)
{
  const std::vector<Curve> curves = curvesOf(tuner);
  const TuningScore& score = tuner.options().score;
  const double start = score(tuner.pooled(tuner.grid().startChoice()));
  const double held_out = score(tuner.heldOut());
  const std::pair<double, double> range = rangeOf(curves, start, held_out);
  const int columns = std::clamp(int(curves.size()), 2, 3);
  const int rows = (int(curves.size()) + columns - 1) / columns;
  cv::Mat picture(legend_height + rows * panel_height, columns * panel_width, CV_8UC3,
                  cv::Scalar::all(255));
  drawLegend(picture, tuner.options().score.describe() + " [%]");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const TuningAxis& axis = tuner.grid().axes[i];
    const cv::Rect place(int(i) % columns * panel_width,
                         legend_height + int(i) / columns * panel_height, panel_width,
                         panel_height);
    Panel panel(picture(place), axis.candidates.size(), range);
    panel.drawFrame(axis, tuner.chosen()[i]);
    panel.drawLevel(start, black);
    panel.drawLevel(held_out, {120, 180, 245}); // paler
    panel.drawCurve(curves[i].all, axis.is_number, all_colour, 5);
    panel.drawCurve(curves[i].held_out, axis.is_number, held_out_colour, 2);
  }
  return picture;
}

} // namespace pcl_semantic
