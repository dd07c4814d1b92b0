// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_survey.h"

#include "core/fail.h"
#include "core/point_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace pcl_semantic {

namespace {

constexpr std::size_t kSampleSize = std::size_t(1) << 19;
constexpr std::size_t kSpacingSample = 128;

// Whether a point is in a random sample of some in all.
bool
isSampled(std::uint64_t point, std::size_t some, std::size_t all)
{
  std::uint64_t hash = (point + 1) * 0x9e3779b97f4a7c15u;
  hash ^= hash >> 32;
  hash *= 0xbf58476d1ce4e5b9u;
  hash ^= hash >> 29;
  return double(hash >> 11) * 0x1p-53 * double(all) < double(some);
}

// Written so that NaN fails.
bool
isNear(const Eigen::Vector3f& position)
{
  return (position.array().abs() <= CloudCRF::max_coordinate).all();
}

class Surveyor {
public:
  Surveyor(PcdReader& reader, const LabelMapping* mapping,
           const std::function<void()>& step)
      : reader_(reader), mapping_(mapping), step_(step)
  {
    survey_.class_sums = Eigen::VectorXd::Zero(256);
    survey_.sample.points = reader.size();
    survey_.sample.low.setConstant(std::numeric_limits<float>::max());
    survey_.sample.colour_low.setConstant(255.0f);
  }

  CloudSurvey
  survey()
  {
    forEachBlock(reader_, [&](std::size_t first, PcdTable table) {
      const LabelledCloud block =
          labelledCloudOf(std::move(table), reader_.path(), mapping_);
      requireSameKind(block, first);
      addFigures(block);
      addSample(block, first);
      step_();
    });
    if (survey_.no_returns == 1)
      survey_.no_returns = 0; // may be real
    finishSample();
    return std::move(survey_);
  }

private:
  void
  requireSameKind(const LabelledCloud& block, std::size_t first)
  {
    const bool has_channels = block.has_colour && reader_.header().find("rgb") < 0 &&
                              reader_.header().find("rgba") < 0;
    if (has_channels)
      badInput(reader_.path(),
               ": its colours are in one field each, and their range follows from all "
               "points, so the cloud has to be read as a whole");
    const auto kindOf = [](const CloudSurvey& survey) {
      return std::tie(survey.has_labels, survey.has_colour, survey.classes,
                      survey.label_source);
    };
    CloudSurvey found;
    found.has_labels = block.has_labels;
    found.has_colour = block.has_colour;
    found.classes = block.distributions.classes();
    found.label_source = block.table.label_source;
    if (first > 0 && kindOf(found) != kindOf(survey_))
      badInput(reader_.path(), ": the fields of points ", first, " to ",
               first + block.cloud->size() - 1,
               " have another meaning than those before: labels from '",
               found.label_source, "' and ", found.classes,
               " probabilities, expected '", survey_.label_source, "' and ",
               survey_.classes);
    std::tie(survey_.has_labels, survey_.has_colour, survey_.classes,
             survey_.label_source) = kindOf(found);
  }

  void
  addFigures(const LabelledCloud& block)
  {
    for (const std::string& doubt : block.table.doubts)
      if (!std::count(survey_.doubts.begin(), survey_.doubts.end(), doubt))
        survey_.doubts.push_back(doubt);
    const auto& matrix = block.distributions.matrix();
    for (std::size_t i = 0; i < block.cloud->size(); ++i) {
      const std::uint32_t label = (*block.cloud)[i].label;
      survey_.largest_label = std::max(survey_.largest_label, label);
      bool has_preference = label != kUnlabelled;
      bool has_measurement = has_preference;
      if (survey_.classes > 0) {
        const auto column = matrix.col(Eigen::Index(i));
        has_preference = column.maxCoeff() - column.minCoeff() >= 1e-6f;
        has_measurement = !column.isZero(0.0f);
        if (has_preference)
          survey_.class_sums.head(survey_.classes) += column.cast<double>();
      }
      else if (has_preference)
        survey_.class_sums[Eigen::Index(label) - 1] += 1.0;
      survey_.without_preference += !has_preference;
      survey_.sample.unlabelled += !has_measurement;
    }
  }

  void
  addSample(const LabelledCloud& block, std::size_t first)
  {
    CloudSample& sample = survey_.sample;
    if (first == 0)
      sample.origin = block.origin;
    const CloudPositions positions(block);
    for (std::size_t i = 0; i < block.cloud->size(); ++i) {
      const pcl::PointXYZRGBL& point = (*block.cloud)[i];
      const Eigen::Vector3d absolute = positions(i);
      const bool is_zero = absolute.isZero(0.0);
      survey_.no_returns += is_zero;
      const Eigen::Vector3f position = (absolute - sample.origin).cast<float>();
      if (is_zero || !isNear(position))
        continue;
      sample.low = sample.low.cwiseMin(position);
      const Eigen::Vector3f colour(float(point.r), float(point.g), float(point.b));
      sample.colour_low = sample.colour_low.cwiseMin(colour);
      if (!isSampled(first + i, kSampleSize, reader_.size()))
        continue;
      positions_.push_back(position);
      if (block.has_colour)
        colours_.push_back(colour);
    }
  }

  static Eigen::Matrix3Xf
  matrixOf(const std::vector<Eigen::Vector3f>& columns)
  {
    Eigen::Matrix3Xf matrix(3, Eigen::Index(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      matrix.col(Eigen::Index(i)) = columns[i];
    return matrix;
  }

  void
  finishSample()
  {
    survey_.sample.positions = matrixOf(positions_);
    survey_.sample.colours = matrixOf(colours_);
    if (positions_.empty())
      survey_.sample.low.setZero();
  }

  PcdReader& reader_;
  const LabelMapping* mapping_;
  const std::function<void()>& step_;
  CloudSurvey survey_;
  std::vector<Eigen::Vector3f> positions_, colours_;
};

} // namespace

void
forEachBlock(PcdReader& reader, const std::function<void(std::size_t, PcdTable)>& use)
{
  for (std::size_t first = 0; first < reader.size(); first += kBlockOfPoints)
    use(first, reader.read(first, std::min(kBlockOfPoints, reader.size() - first)));
}

PointPlaces
CloudSurvey::placesOf(const PcdTable& table) const
{
  PointPlaces places;
  Eigen::Matrix3Xf& positions = places.positions;
  positions.resize(3, Eigen::Index(table.points()));
  places.no_returns.assign(table.points(), 0);
  const std::array<PcdColumn, 3> columns{PcdColumn(table, table.find("x")),
                                         PcdColumn(table, table.find("y")),
                                         PcdColumn(table, table.find("z"))};
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    Eigen::Vector3d absolute;
    for (int axis = 0; axis < 3; ++axis)
      absolute[axis] = columns[std::size_t(axis)](std::size_t(i));
    positions.col(i) = (absolute - sample.origin).cast<float>();
    const bool is_no_return = no_returns > 0 && absolute.isZero(0.0);
    places.no_returns[std::size_t(i)] = is_no_return;
    if (is_no_return || !isNear(positions.col(i)))
      positions.col(i).setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  return places;
}

void
measureSpacing(PcdReader& reader, const std::function<void()>& step,
               CloudSurvey& survey)
{
  const Eigen::Matrix3Xf& positions = survey.sample.positions;
  const auto chosen = sampleByPosition(positions, kSpacingSample);
  Eigen::MatrixXf points(3, Eigen::Index(chosen.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = positions.col(chosen[std::size_t(k)]);
  SpacingSample spacing(points);
  forEachBlock(reader, [&](std::size_t, const PcdTable& table) {
    const Eigen::Matrix3Xf all = survey.placesOf(table).positions;
    Eigen::MatrixXf axes(all.cols(), 3);
    Eigen::Index rows = 0;
    for (Eigen::Index i = 0; i < all.cols(); ++i)
      if (isNear(all.col(i)))
        axes.row(rows++) = all.col(i).transpose();
    survey.without_place += std::size_t(all.cols() - rows);
    spacing.add(axes.topRows(rows));
    step();
  });
  if (reader.size() - survey.without_place > std::size_t(SpacingSample::neighbours) &&
      points.cols() > 0)
    survey.sample.spacing = double(spacing.spacing());
}

CloudSurvey
surveyCloud(PcdReader& reader, const LabelMapping* mapping,
            const std::function<void()>& step)
{
  return Surveyor(reader, mapping, step).survey();
}

} // namespace pcl_semantic
