// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/label_comparison.h>

#include "core/fail.h"
#include "core/grey_image.h"
#include "label_changes.h"

#include <pcl_semantic/io/drawing.h>
#include <pcl_semantic/io/map_images.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>

namespace pcl_semantic {

namespace {

constexpr int kGap = 12, kCaption = 28; // [px]
const cv::Vec3b green(70, 190, 40), red(50, 40, 235), yellow(60, 200, 250);

std::vector<Label>
listOf(const cv::Mat& labels)
{
  if (labels.empty()) // has no iterators
    return {};
  return {labels.begin<Label>(), labels.end<Label>()};
}

// Truth of a laser scan is dots that nobody would see: they are drawn larger.
bool
isSparse(const cv::Mat& truth)
{
  return !truth.empty() && cv::countNonZero(truth) < 0.2 * double(truth.total());
}

void
drawDot(cv::Mat& picture, int row, int column, const cv::Scalar& colour)
{
  constexpr int reach = 2; // [px]
  cv::rectangle(picture, cv::Point(column - reach, row - reach),
                cv::Point(column + reach, row + reach), colour, cv::FILLED);
}

cv::Mat
drawTruth(const cv::Mat& image, const cv::Mat& truth, const LabelSet& label_set)
{
  if (!isSparse(truth))
    return blendLabels(image, truth, label_set);
  cv::Mat dots = cv::Mat::zeros(truth.size(), CV_8UC1);
  for (int v = 0; v < truth.rows; ++v)
    for (int u = 0; u < truth.cols; ++u)
      if (truth.at<Label>(v, u) != kUnlabelled)
        drawDot(dots, v, u, cv::Scalar(truth.at<Label>(v, u)));
  return blendLabels(image, dots, label_set);
}

// The image in grey, pale, and on it the pixels that changed.
cv::Mat
drawChanges(const cv::Mat& image, const cv::Mat& before, const cv::Mat& after,
            const cv::Mat& truth, const LabelSet& label_set)
{
  cv::Mat picture;
  cv::cvtColor(greyImage(image), picture, cv::COLOR_GRAY2BGR);
  picture.convertTo(picture, -1, 0.45, 120.0);
  const bool sparse = isSparse(truth);
  for (const bool with_truth : {false, true}) // dots lie on top
    for (int v = 0; v < picture.rows; ++v)
      for (int u = 0; u < picture.cols; ++u) {
        const Label from = before.at<Label>(v, u), to = after.at<Label>(v, u);
        const Label right = truth.empty() ? kUnlabelled : truth.at<Label>(v, u);
        if (from == kUnlabelled || to == kUnlabelled || from == to ||
            with_truth != (right != kUnlabelled))
          continue;
        const cv::Vec3b colour = !with_truth     ? classColour(label_set, to)
                                 : to == right   ? green
                                 : from == right ? red
                                                 : yellow;
        if (with_truth && sparse)
          drawDot(picture, v, u, cv::Scalar(colour));
        else
          picture.at<cv::Vec3b>(v, u) = colour;
      }
  return picture;
}

std::string
captionOf(const std::string& before, const LabelChanges& changes, bool has_truth)
{
  const double part = 100.0 * double(changes.changed) /
                      double(std::max<std::size_t>(1, changes.compared));
  std::string caption =
      cv::format("where it differs from %s: %.1f %%", before.c_str(), part);
  if (has_truth)
    caption += cv::format(", %zu pixels became right, %zu wrong", changes.right,
                          changes.wrong);
  return caption;
}

// The figure as a grid of two columns of panels of one size.
class Figure {
public:
  Figure(int width, int rows, cv::Size image) : panel_((width - 3 * kGap) / 2, 0)
  {
    panel_.height =
        std::max(1, cvRound(double(panel_.width) * image.height / image.width));
    picture_ = cv::Mat(rows * (panel_.height + kCaption + kGap / 2), width, CV_8UC3,
                       light_theme.background);
  }

  void
  put(int row, int column, const cv::Mat& panel, const std::string& caption)
  {
    const cv::Point corner(kGap + column * (panel_.width + kGap),
                           row * (panel_.height + kCaption + kGap / 2) + kCaption);
    const int method = panel.cols > panel_.width ? cv::INTER_AREA : cv::INTER_NEAREST;
    cv::Mat place = picture_(cv::Rect(corner, panel_));
    cv::resize(panel, place, panel_, 0, 0, method);
    drawText(picture_, caption, corner - cv::Point(0, 9), light_theme.text,
             std::min(1.0, double(panel_.width) / textWidth(caption)));
  }

  cv::Mat
  with(const std::vector<LegendEntry>& legend) const
  {
    return withLegend(picture_, legend, light_theme);
  }

private:
  cv::Size panel_;
  cv::Mat picture_;
};

std::vector<LegendEntry>
legendFor(const std::vector<NamedLabels>& labels, const cv::Mat& truth,
          const LabelSet& label_set)
{
  std::array<bool, 256> is_there{};
  const auto mark = [&](const cv::Mat& image) {
    for (const Label label : listOf(image))
      is_there[label] = true;
  };
  for (const NamedLabels& each : labels)
    mark(each.labels);
  mark(truth);
  std::vector<LegendEntry> legend;
  for (int label = 1; label <= label_set.size(); ++label)
    if (is_there[std::size_t(label)])
      legend.push_back(
          {label_set[Label(label)].name, classColour(label_set, Label(label))});
  if (!truth.empty())
    legend.insert(legend.end(), {{"became right", green},
                                 {"became wrong", red},
                                 {"wrong before and after", yellow}});
  return legend;
}

void
validate(const cv::Mat& image, const std::vector<NamedLabels>& labels,
         const cv::Mat& truth, const LabelSet& label_set, int width)
{
  if (width < 320 || width > 16384)
    badParameter("a figure ", width, " pixels wide, expected 320 to 16384");
  if (labels.empty() || image.empty())
    badParameter("a figure needs an image and labels");
  std::vector<NamedLabels> all = labels;
  if (!truth.empty())
    all.push_back({"truth", truth});
  for (const NamedLabels& each : all) {
    if (each.labels.type() != CV_8UC1 || each.labels.size() != image.size())
      badParameter(each.name, ": has ", each.labels.cols, " x ", each.labels.rows,
                   " pixels, the image ", image.cols, " x ", image.rows);
    for (const Label label : listOf(each.labels))
      if (label > label_set.size())
        badParameter(each.name, ": label ", int(label), " is beyond the ",
                     label_set.size(), " classes of the label set");
  }
}

} // namespace

cv::Mat
drawLabelComparison(const cv::Mat& image, const std::vector<NamedLabels>& labels,
                    const cv::Mat& truth, const LabelSet& label_set, int width)
{
  validate(image, labels, truth, label_set, width);
  Figure figure(width, static_cast<int>(labels.size()), image.size());
  cv::Mat shown = image;
  if (image.channels() == 1)
    cv::cvtColor(image, shown, cv::COLOR_GRAY2BGR);
  const std::vector<Label> right = listOf(truth);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const int row = static_cast<int>(i);
    const cv::Mat& after = labels[i].labels;
    figure.put(row, 0, blendLabels(image, after, label_set), labels[i].name);
    if (i == 0 && truth.empty())
      figure.put(row, 1, shown, "image");
    else if (i == 0)
      figure.put(row, 1, drawTruth(image, truth, label_set),
                 isSparse(truth) ? "ground truth, its pixels drawn larger" : "truth");
    else {
      const NamedLabels& before = labels[i - 1];
      figure.put(
          row, 1, drawChanges(image, before.labels, after, truth, label_set),
          captionOf(before.name,
                    countLabelChanges(listOf(before.labels), listOf(after), right),
                    !truth.empty()));
    }
  }
  return figure.with(legendFor(labels, truth, label_set));
}

} // namespace pcl_semantic
