// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/cloud_crf.h>

#include "core/cloud_size.h"
#include "core/fail.h"
#include "core/label_number.h"
#include "core/point_spacing.h"
#include "element_crf.h"
#include "element_model.h"

#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/position_steps.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pcl_semantic {

namespace {

// Indices of points with a position, without duplicates, ascending.
pcl::Indices
validPoints(const Eigen::Matrix3Xf& positions, bool zero_is_none,
            const pcl::Indices& indices, std::size_t& skipped)
{
  std::vector<std::uint8_t> chosen(std::size_t(positions.cols()), 0);
  for (const pcl::index_t index : indices) {
    if (index < 0 || index >= positions.cols())
      badParameter("the index ", index, " is beyond the cloud of ", positions.cols(),
                   " points");
    chosen[std::size_t(index)] = 1;
  }
  pcl::Indices valid;
  valid.reserve(indices.size());
  skipped = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i])
      continue;
    const auto position = positions.col(Eigen::Index(i));
    if (CloudCRF::hasPosition(position) && !(zero_is_none && position.isZero(0.0f)))
      valid.push_back(pcl::index_t(i));
    else
      ++skipped;
  }
  return valid;
}

// Median distance to the origin.
double
extentOf(const Eigen::MatrixXf& positions)
{
  std::vector<float> distances(std::size_t(positions.cols()));
  for (Eigen::Index k = 0; k < positions.cols(); ++k)
    distances[std::size_t(k)] = positions.col(k).norm();
  if (distances.empty())
    return 0.0;
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return double(*middle);
}

// Minimum per coordinate.
VoxelIndex
cornerOf(const std::vector<VoxelIndex>& voxels, const pcl::Indices& indices)
{
  VoxelIndex corner = voxels[std::size_t(indices[0])];
  for (const pcl::index_t index : indices)
    corner = corner.cwiseMin(voxels[std::size_t(index)]);
  return corner;
}

void
requireSize(const char* what, std::size_t size, std::size_t points)
{
  if (size != points)
    badParameter("SemanticCRF has ", what, " of ", size, " points for a cloud of ",
                 points);
}

// Elements without positions.
CRFElements
elementsWithColours(const CloudFields& fields, const pcl::Indices& indices)
{
  CRFElements elements;
  elements.total = fields.labels.size();
  elements.indices = indices;
  elements.positions.resize(3, Eigen::Index(indices.size()));
  if (fields.colours.size() > 0)
    elements.colours = gather(fields.colours, indices);
  return elements;
}

// \param[in] middle of the positions
CRFElements
pointElements(const CloudFields& fields, const pcl::Indices& indices,
              const Eigen::Vector3f& middle)
{
  CRFElements elements = elementsWithColours(fields, indices);
  const bool has_remainders = fields.remainders.size() > 0;
  if (has_remainders)
    elements.remainders.resize(3, Eigen::Index(indices.size()));
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < indices.size(); ++k) {
    auto position = elements.positions.col(Eigen::Index(k));
    position = fields.positions.col(indices[k]) - middle;
    if (has_remainders)
      elements.remainders.col(Eigen::Index(k)) =
          (fields.positions.col(indices[k]).cast<double>() - middle.cast<double>() -
           position.cast<double>() + fields.remainders.col(indices[k]).cast<double>())
              .cast<float>();
  }
  return elements;
}

CRFElements
voxelElements(const CloudFields& fields, const pcl::Indices& indices,
              const std::vector<VoxelIndex>& voxels, double voxel_size)
{
  CRFElements elements = elementsWithColours(fields, indices);
  const VoxelIndex corner = cornerOf(voxels, indices);
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < indices.size(); ++k)
    elements.positions.col(Eigen::Index(k)) =
        ((voxels[std::size_t(indices[k])] - corner).cast<double>() * voxel_size)
            .cast<float>();
  elements.spacing = voxel_size;
  return elements;
}

} // namespace

void
CloudCRF::setLabelConfidence(double confidence, int classes)
{
  if (!(confidence >= 0.0 && confidence <= 1.0))
    badParameter("label confidence is ", confidence, ", expected 0 to 1");
  if (classes < 1 || classes > 255)
    badParameter("labels are of ", classes, " classes, expected 1 to 255");
  measured_ = LabelDistributions();
  label_confidence_ = confidence;
  label_classes_ = classes;
}

void
CloudCRF::setTileSize(std::size_t points)
{
  if (points == 0)
    badParameter("a tile of 0 points, expected 1 or more");
  tile_size_ = points;
}

void
CloudCRF::setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size)
{
  if (!indices.empty() && !(voxel_size > 0.0 && std::isfinite(voxel_size)))
    badParameter("voxel size is ", voxel_size, " m, expected more than 0");
  voxels_ = indices;
  voxel_size_ = voxel_size;
}

void
CloudCRF::setOrigin(const Eigen::Vector3d& origin)
{
  if (!origin.allFinite())
    badParameter("the origin of the clouds is not finite");
  origin_ = origin;
  judges_steps_ = false;
}

void
CloudCRF::setRemainders(Eigen::Matrix3Xf remainders)
{
  if (!remainders.allFinite())
    badParameter("a remainder of a position is not finite");
  remainders_ = std::move(remainders);
}

// Chooses the methods of the kernels by a sample.
// \param[in] points of the whole cloud
void
CloudCRF::setMethods(const std::vector<Eigen::Index>& sample, std::size_t points,
                     CRFElements& elements) const
{
  CRFElements part;
  const pcl::Indices columns(sample.begin(), sample.end());
  part.positions = gather(elements.positions, columns);
  if (elements.colours.size() > 0)
    part.colours = gather(elements.colours, columns);
  part.spacing = elements.spacing;
  part.extent = elements.extent;
  const double density =
      double(points) / double(std::max<std::size_t>(sample.size(), 1));
  elements.choice =
      GaussianKernels::Choice{chooseKernels(terms_, part, density).choice.methods, {}};
}

double
CloudCRF::setWhole(const CloudSample& whole)
{
  CRFElements sample;
  sample.positions = whole.positions;
  if (use_colour_ && whole.has_colour)
    sample.colours.setZero(3, whole.positions.cols());
  sample.spacing = whole.spacing;
  pcl::Indices all(std::size_t(whole.positions.cols()));
  std::iota(all.begin(), all.end(), 0);
  if (!all.empty())
    sample.extent =
        extentOf(whole.positions.colwise() - medianOf(whole.positions, all));
  setMethods(sampleByPosition(whole.positions, GaussianKernels::max_sample,
                              PositionHash(whole.low)),
             whole.points, sample);
  const KernelChoice kernels = chooseKernels(terms_, sample);
  whole_ = Whole{sample.spacing, sample.extent, kernels.choice.methods,
                 whole.origin + whole.low.cast<double>(), whole.colour_low};
  return kernels.reach * haloOf(whole.unlabelled, whole.points,
                                resolvedFor(sample, terms_.parameters).iterations);
}

CRFElements
CloudCRF::elementsOf(const CloudFields& fields, const pcl::Indices& indices) const
{
  if (!voxels_.empty())
    return voxelElements(fields, indices, voxels_, voxel_size_);
  // The median as origin keeps single precision for clouds far from 0. Unlike the first
  // point or the mean, it depends neither on the order nor on outliers.
  const Eigen::Vector3f middle = medianOf(fields.positions, indices);
  CRFElements elements = pointElements(fields, indices, middle);
  terms_.checkInterruption();
  if (!whole_) {
    const auto sample = sampleByPosition(gather(fields.positions, indices),
                                         GaussianKernels::max_sample);
    terms_.checkInterruption();
    elements.spacing = double(pointSpacing(elements.positions, sample));
    terms_.checkInterruption();
    elements.extent = extentOf(elements.positions);
    elements.tile_size = tile_size_;
    setMethods(sample, indices.size(), elements);
    return elements;
  }
  elements.remainders.resize(3, 0); // a part has an origin of its own
  elements.spacing = whole_->spacing;
  elements.extent = whole_->extent;
  const Eigen::Vector3d low = whole_->low - fields.origin - middle.cast<double>();
  elements.choice = choiceFor(
      resolvedFor(elements, terms_.parameters), whole_->methods, low.cast<float>(),
      elements.colours.size() > 0 ? Eigen::MatrixXf(whole_->colour_low)
                                  : Eigen::MatrixXf());
  return elements;
}

std::vector<std::uint32_t>
CloudCRF::labelsOf(const std::vector<double>& numbers, bool is_single) const
{
  std::vector<std::uint32_t> labels(numbers.size(), kUnlabelled);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double number = numbers[i];
    const bool is_exact =
        number == std::floor(number) &&
        std::abs(number) < (is_single ? kFirstInexactFloat : 4294967296.0);
    const std::int64_t label = is_exact ? withoutInstance(std::int64_t(number)) : -1;
    if (label >= 0)
      labels[i] = std::uint32_t(label);
    else if (label_classes_ > 0)
      badInput("point ", i, " has the label ", number,
               ", expected a whole number from 0 to ", label_classes_,
               is_single && std::abs(number) >= kFirstInexactFloat
                   ? "; single precision does not hold a class beside such an instance"
                   : "");
  }
  return labels;
}

void
CloudCRF::setCliques(const std::vector<pcl::PointIndices>& cliques)
{
  requireMembers(cliques);
  cliques_ = cliques;
  generator_.reset();
}

LabelDistributions
CloudCRF::measurements(const CloudFields& fields, const pcl::Indices& indices,
                       const LabelDistributions* own)
{
  const std::size_t count = fields.labels.size();
  if (label_classes_ == 0) {
    const LabelDistributions& measured = own && !hasMeasurements() ? *own : measured_;
    if (measured.classes() == 0)
      badParameter("SemanticCRF needs measurements: setLabelDistributions() or "
                   "setLabelConfidence()");
    requireSize("label distributions", std::size_t(measured.size()), count);
    if (is_measured_once_ && &measured == &measured_)
      return std::exchange(measured_, LabelDistributions());
    return measured;
  }
  LabelDistributions distributions(label_classes_, Eigen::Index(count));
  for (const pcl::index_t i : indices)
    if (fields.labels[std::size_t(i)] > std::uint32_t(label_classes_))
      badInput("point ", i, " has the label ", fields.labels[std::size_t(i)],
               ", expected 0 to ", label_classes_);
  for (std::size_t i = 0; i < count; ++i)
    if (fields.labels[i] <= std::uint32_t(label_classes_))
      distributions.setLabel(Eigen::Index(i), Label(fields.labels[i]),
                             float(label_confidence_));
  return distributions;
}

std::vector<pcl::PointIndices>
CloudCRF::makeCliques(const CloudFields& fields) const
{
  const bool has_colours = fields.colours.size() > 0;
  if (generator_->usesColour() && !has_colours)
    badParameter("these cliques need points with colour");
  requireCloudSize(fields.width, fields.height, fields.labels.size());
  CliqueGenerator::Cloud cloud(fields.width, fields.height);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f position = fields.positions.col(Eigen::Index(i));
    pcl::PointXYZRGB& point = cloud[i];
    if (hasPosition(position))
      point.getVector3fMap() = position;
    else {
      point.x = point.y = point.z = std::numeric_limits<float>::quiet_NaN();
      cloud.is_dense = false;
    }
    if (has_colours) {
      const auto colour = fields.colours.col(Eigen::Index(i)).cast<std::uint8_t>();
      point.r = colour(0);
      point.g = colour(1);
      point.b = colour(2);
    }
  }
  generator_->setOrigin(fields.origin);
  std::vector<pcl::PointIndices> cliques = generator_->generate(cloud);
  requireMembers(cliques);
  return cliques;
}

void
CloudCRF::runEmpty()
{
  const int classes = std::max(label_classes_, measured_.classes());
  refined_ = classes > 0 ? LabelDistributions(classes, 0) : LabelDistributions();
  skipped_points_ = 0;
  report_ = CRFReport();
}

void
CloudCRF::run(CloudFields& fields, const pcl::Indices& indices,
              const LabelDistributions* measured,
              const std::vector<pcl::PointIndices>* cliques)
{
  const std::size_t count = fields.labels.size();
  if (judges_steps_ && fields.is_single && voxels_.empty())
    warnOfDoubt("SemanticCRF", doubtOfSteps(fields.positions, fields.origin, "cloud"));
  if (!use_colour_)
    fields.colours.resize(3, 0);
  if (!voxels_.empty())
    requireSize("voxel indices", voxels_.size(), count);
  if (fields.remainders.size() > 0)
    requireSize("remainders of positions", std::size_t(fields.remainders.cols()),
                count);
  // Voxels have positions from their indices, so a zero is valid there.
  const auto isZero = [&](std::size_t i) {
    return fields.positions.col(Eigen::Index(i)).isZero(0.0f);
  };
  const bool zero_is_none = voxels_.empty() && countNoReturns(count, isZero) > 0;
  const pcl::Indices valid =
      validPoints(fields.positions, zero_is_none, indices, skipped_points_);
  refined_ = LabelDistributions(); // before new memory is needed
  refined_ = measurements(fields, indices, measured);
  terms_.checkInterruption();
  for (const pcl::index_t index : indices)
    if (!hasPosition(fields.positions.col(index))) {
      fields.labels[std::size_t(index)] = kUnlabelled;
      refined_.matrix().col(index).setZero();
    }
  std::vector<pcl::PointIndices> made;
  if (cliques_)
    cliques = &*cliques_;
  else if (generator_ && terms_.usesCliques() && !valid.empty()) {
    made = makeCliques(fields);
    cliques = &made;
  }
  CRFElements elements;
  if (!valid.empty())
    elements = elementsOf(fields, valid);
  fields.positions.resize(3, 0);
  fields.remainders.resize(3, 0);
  fields.colours.resize(3, 0);
  report_ = refineElements(terms_, cliques, elements, refined_);
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < valid.size(); ++k)
    fields.labels[std::size_t(valid[k])] = refined_.mapLabel(valid[k]);
}

} // namespace pcl_semantic
