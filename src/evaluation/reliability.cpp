// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/reliability.h>

#include "core/fail.h"
#include "files/report_text.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace pcl_semantic {

Reliability::Bin&
Reliability::Bin::operator+=(const Bin& other)
{
  pixels += other.pixels;
  right += other.right;
  probability += other.probability;
  return *this;
}

void
Reliability::count(float probability, bool is_right, Curve& curve)
{
  const int bin = std::clamp(int(probability * float(kBins)), 0, kBins - 1);
  Bin& counted = curve[std::size_t(bin)];
  ++counted.pixels;
  counted.right += is_right;
  counted.probability += double(probability);
}

Reliability::Reliability(int classes, const std::vector<Label>& evaluated)
    : classes_(classes), evaluated_(evaluated), is_evaluated_(256, false),
      curves_(std::size_t(classes) + 1, Curve(kBins))
{
  for (const Label label : evaluated) {
    if (label == kUnlabelled || int(label) > classes)
      badParameter("class ", int(label), ", expected 1 to ", classes);
    is_evaluated_[label] = true;
  }
}

void
Reliability::add(const cv::Mat& truth, const LabelDistributions& predicted)
{
  if (truth.type() != CV_8UC1 || !truth.isContinuous() ||
      std::size_t(predicted.size()) != truth.total() || predicted.classes() != classes_)
    badInput("the distributions are ", predicted.classes(), " x ", predicted.size(),
             ", expected ", classes_, " x ", truth.total());
  for (Eigen::Index i = 0; i < predicted.size(); ++i) {
    const Label label = truth.data[i];
    const Label likeliest = predicted.mapLabel(i);
    if (!is_evaluated_[label] || likeliest == kUnlabelled)
      continue;
    const float* const p = predicted.column(i);
    count(p[likeliest - 1], likeliest == label, curves_[0]);
    for (const Label each : evaluated_)
      count(p[each - 1], each == label, curves_[each]);
  }
}

Reliability&
Reliability::operator+=(const Reliability& other)
{
  if (other.classes_ != classes_ || other.evaluated_ != evaluated_)
    badParameter("reliabilities of different classes cannot be pooled");
  for (std::size_t c = 0; c < curves_.size(); ++c)
    for (std::size_t b = 0; b < curves_[c].size(); ++b)
      curves_[c][b] += other.curves_[c][b];
  return *this;
}

double
expectedCalibrationError(const Reliability::Curve& curve)
{
  double sum = 0.0, pixels = 0.0;
  for (const Reliability::Bin& bin : curve) {
    sum += std::abs(double(bin.right) - bin.probability);
    pixels += double(bin.pixels);
  }
  return sum / pixels; // 0 / 0 is NaN
}

std::string
reliabilityTable(const Reliability& reliability, const LabelSet& label_set)
{
  std::string text = "expected calibration error\n";
  const auto line = [&](const std::string& name, const Reliability::Curve& curve) {
    const double error = 100.0 * expectedCalibrationError(curve);
    char figure[16] = "-";
    if (!std::isnan(error))
      std::snprintf(figure, sizeof(figure), "%.1f", error);
    const std::string shown(figure);
    text += "  " + name + std::string(name.size() < 22 ? 22 - name.size() : 1, ' ') +
            std::string(6 - std::min<std::size_t>(shown.size(), 6), ' ') + shown + "\n";
  };
  line("most probable class", reliability.ofConfidence());
  for (const Label label : reliability.evaluated())
    line(label_set[label].name, reliability.of(label));
  return text;
}

std::string
reliabilityJson(const Reliability& reliability, const LabelSet& label_set)
{
  const auto jsonOf = [](const std::string& name, const Reliability::Curve& curve) {
    nlohmann::ordered_json json = {{"name", name}};
    json["expected_calibration_error"] = expectedCalibrationError(curve);
    for (const Reliability::Bin& bin : curve)
      json["bins"].push_back({{"pixels", bin.pixels},
                              {"probability", bin.meanProbability()},
                              {"frequency", bin.frequency()}});
    return json;
  };
  nlohmann::ordered_json json; // NaN becomes null
  json["confidence"] = jsonOf("most probable class", reliability.ofConfidence());
  for (const Label label : reliability.evaluated())
    json["classes"].push_back(jsonOf(label_set[label].name, reliability.of(label)));
  return jsonText(json);
}

namespace {

constexpr int kPlot = 400, kMargin = 50; // [px]

cv::Point
pixelOf(double probability, double frequency)
{
  return {kMargin + int(std::lround(probability * kPlot)),
          kMargin + int(std::lround((1.0 - frequency) * kPlot))};
}

void
drawText(cv::Mat& plot, const std::string& text, const cv::Point& where,
         const cv::Scalar& colour)
{
  cv::putText(plot, text, where, cv::FONT_HERSHEY_SIMPLEX, 0.42, colour, 1,
              cv::LINE_AA);
}

// Bins of few pixels say little.
void
drawCurve(cv::Mat& plot, const Reliability::Curve& curve, const cv::Scalar& colour,
          int width)
{
  constexpr std::uint64_t enough = 50;
  std::vector<cv::Point> points;
  for (const Reliability::Bin& bin : curve)
    if (bin.pixels >= enough)
      points.push_back(pixelOf(bin.meanProbability(), bin.frequency()));
  cv::polylines(plot, points, false, colour, width, cv::LINE_AA);
  for (const cv::Point& point : points)
    cv::circle(plot, point, width + 1, colour, cv::FILLED, cv::LINE_AA);
}

} // namespace

cv::Mat
reliabilityDiagram(const Reliability& reliability, const LabelSet& label_set)
{
  constexpr int legend = 190;
  cv::Mat plot(kPlot + 2 * kMargin, kPlot + 2 * kMargin + legend, CV_8UC3,
               cv::Scalar::all(255));
  const cv::Scalar black = cv::Scalar::all(0), grey = cv::Scalar::all(200);
  for (int tick = 0; tick <= 5; ++tick) {
    const double at = tick / 5.0;
    cv::line(plot, pixelOf(at, 0), pixelOf(at, 1), grey);
    cv::line(plot, pixelOf(0, at), pixelOf(1, at), grey);
    const std::string text = std::to_string(tick * 20);
    drawText(plot, text, pixelOf(at, 0) + cv::Point(-8, 18), black);
    drawText(plot, text, pixelOf(0, at) + cv::Point(-32, 5), black);
  }
  cv::line(plot, pixelOf(0, 0), pixelOf(1, 1), grey, 2, cv::LINE_AA);
  drawText(plot, "probability [%]", pixelOf(0.35, 0) + cv::Point(0, 38), black);
  drawText(plot, "right [%]", pixelOf(0, 1) + cv::Point(-40, -14), black);
  cv::Point entry = pixelOf(1, 1) + cv::Point(20, 10);
  const auto add = [&](const std::string& name, const Reliability::Curve& curve,
                       const cv::Scalar& colour, int width) {
    drawCurve(plot, curve, colour, width);
    cv::line(plot, entry, entry + cv::Point(20, 0), colour, width, cv::LINE_AA);
    drawText(plot, name, entry + cv::Point(28, 4), black);
    entry.y += 20;
  };
  for (const Label label : reliability.evaluated()) {
    const auto& [red, green, blue] = label_set[label].colour;
    add(label_set[label].name, reliability.of(label), cv::Scalar(blue, green, red), 1);
  }
  add("most probable class", reliability.ofConfidence(), black, 2);
  return plot;
}

} // namespace pcl_semantic
