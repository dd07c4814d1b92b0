// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_survey.h"

#include "core/fail.h"
#include "core/point_spacing.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace pcl_semantic {

namespace {

constexpr std::size_t kSampleSize = std::size_t(1) << 19;

// Whether a point is in a random sample of some in all.
bool
isSampled(std::uint64_t hash, std::size_t some, std::size_t all)
{
  return double(hash >> 11) * 0x1p-53 * double(all) < double(some);
}

// Without numbers: doubts of two blocks may differ in their figures.
std::string
withoutNumbers(std::string text)
{
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](char c) { return c >= '0' && c <= '9'; }),
             text.end());
  return text;
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
      const LabelledCloud block = cloudOf(std::move(table), first);
      requireSameKind(block, first);
      addDoubts(block);
      if (first == 0)
        survey_.sample.origin = block.origin;
      const std::vector<bool> has_place = placesOf(block);
      addFigures(block, has_place, first);
      step_();
    });
    CloudSample& sample = survey_.sample;
    sample.has_colour = survey_.has_colour;
    if (survey_.no_returns == 1) { // may be real
      survey_.no_returns = 0;
      sample.low = sample.low.cwiseMin((-sample.origin).cast<float>());
    }
    takeSample();
    if (sample.positions.cols() == 0)
      sample.low.setZero();
    return std::move(survey_);
  }

private:
  LabelledCloud
  cloudOf(PcdTable table, std::size_t first) const
  {
    try {
      return labelledCloudOf(std::move(table), reader_.path(), mapping_);
    }
    catch (const BadInputException& error) {
      if (first == 0)
        throw;
      badInput(error.what(), " (points are counted from point ", first, " on)");
    }
  }

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
      badInput(block.table.doubts.empty()
                   ? reader_.path() + ": fields have another meaning"
                   : block.table.doubts.front(),
               "; only points ", first, " to ", first + block.cloud->size() - 1,
               " are read so, not those before: the cloud has to be read as a whole");
    std::tie(survey_.has_labels, survey_.has_colour, survey_.classes,
             survey_.label_source) = kindOf(found);
  }

  void
  addDoubts(const LabelledCloud& block)
  {
    for (const std::string& doubt : block.table.doubts)
      if (std::none_of(survey_.doubts.begin(), survey_.doubts.end(),
                       [&](const std::string& known) {
                         return withoutNumbers(known) == withoutNumbers(doubt);
                       }))
        survey_.doubts.push_back(doubt);
  }

  void
  addFigures(const LabelledCloud& block, const std::vector<bool>& has_place,
             std::size_t first)
  {
    const auto& matrix = block.distributions.matrix();
    for (std::size_t i = 0; i < block.cloud->size(); ++i) {
      const std::uint32_t label = (*block.cloud)[i].label;
      survey_.largest_label = std::max(survey_.largest_label, label);
      std::size_t& of_label = survey_.first_of_label[std::min(label, 255u)];
      of_label = std::min(of_label, first + i);
      bool has_preference = label != kUnlabelled;
      bool has_measurement = has_preference;
      if (survey_.classes > 0) {
        const auto column = matrix.col(Eigen::Index(i));
        has_preference = column.maxCoeff() - column.minCoeff() >= 1e-6f;
        has_measurement = !column.isZero(0.0f);
        if (has_preference && has_place[i])
          survey_.class_sums.head(survey_.classes) += column.cast<double>();
      }
      else if (has_preference && has_place[i])
        survey_.class_sums[Eigen::Index(label) - 1] += 1.0;
      survey_.without_preference += !has_preference;
      survey_.sample.unlabelled += !has_measurement && has_place[i];
    }
  }

  // \return which points have a place; those at 0 0 0 may have none
  std::vector<bool>
  placesOf(const LabelledCloud& block)
  {
    CloudSample& sample = survey_.sample;
    std::vector<bool> has_place(block.cloud->size(), false);
    const CloudPositions positions(block);
    for (std::size_t i = 0; i < block.cloud->size(); ++i) {
      const pcl::PointXYZRGBL& point = (*block.cloud)[i];
      const Eigen::Vector3d absolute = positions(i);
      const bool is_zero = absolute.isZero(0.0);
      survey_.no_returns += is_zero;
      const Eigen::Vector3f position = (absolute - sample.origin).cast<float>();
      if (is_zero || !CloudCRF::hasPosition(position))
        continue;
      has_place[i] = true;
      sample.low = sample.low.cwiseMin(position);
      const Eigen::Vector3f colour(float(point.r), float(point.g), float(point.b));
      sample.colour_low = sample.colour_low.cwiseMin(colour);
    }
    return has_place;
  }

  void
  takeSample()
  {
    const PositionHash hash(survey_.sample.low);
    std::vector<Eigen::Vector3f> positions;
    forEachBlock(reader_, [&](std::size_t, const PcdTable& table) {
      const Eigen::Matrix3Xf all = survey_.placesOf(table).positions;
      for (Eigen::Index i = 0; i < all.cols(); ++i)
        if (CloudCRF::hasPosition(all.col(i)) &&
            isSampled(hash(all.col(i)), kSampleSize, reader_.size()))
          positions.push_back(all.col(i));
      step_();
    });
    survey_.sample.positions.resize(3, Eigen::Index(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i)
      survey_.sample.positions.col(Eigen::Index(i)) = positions[i];
  }

  PcdReader& reader_;
  const LabelMapping* mapping_;
  const std::function<void()>& step_;
  CloudSurvey survey_;
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
    if (is_no_return || !CloudCRF::hasPosition(positions.col(i)))
      positions.col(i).setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  return places;
}

void
measureSpacing(PcdReader& reader, const std::function<void()>& step,
               CloudSurvey& survey)
{
  const Eigen::Matrix3Xf& positions = survey.sample.positions;
  const auto chosen = sampleByPosition(positions, sizeOfSpacingSample(reader.size()),
                                       PositionHash(survey.sample.low));
  Eigen::Matrix3Xf points(3, Eigen::Index(chosen.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = positions.col(chosen[std::size_t(k)]);
  SpacingSample spacing(points);
  forEachBlock(reader, [&](std::size_t, const PcdTable& table) {
    const Eigen::Matrix3Xf all = survey.placesOf(table).positions;
    Eigen::MatrixX3f axes(all.cols(), 3);
    Eigen::Index rows = 0;
    for (Eigen::Index i = 0; i < all.cols(); ++i)
      if (CloudCRF::hasPosition(all.col(i)))
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
