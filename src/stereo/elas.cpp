// SPDX-License-Identifier: BSD-3-Clause
#include "elas.h"
#include "core/grey_image.h"
#include "core/parallel_guard.h"
#include "disparity_cleaning.h"
#include "image_pair.h"
#include "kernels/map_disparity.h"
#include "plane_prior.h"
#include "support_points.h"

#include <pcl_semantic/core/exceptions.h>

#include <opencv2/core/mat.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

namespace pcl_semantic {

/** \brief Matches rows of two images in both directions, one thread's; refers to what
 * it is given. */
class BandMatcher {
public:
  /** \param[in] images left, right
   * \param[in] priors left, right */
  BandMatcher(const std::array<GradientImage, 2>& images,
              const std::array<PlanePrior, 2>& priors,
              const Elas::Parameters& parameters);

  /** \brief Disparities of rows [begin, end) of the left image that the right one
   * agrees with (CV_16SC1, [1 / disparity_steps px], no_disparity = none). */
  void match(int begin, int end, cv::Mat& disparity);

private:
  void matchRow(std::size_t image, int v, const std::int16_t* expected,
                std::int16_t* disparity);

  void dropContradicted(std::int16_t* disparity) const;

  const std::array<GradientImage, 2>& images_;
  const std::array<PlanePrior, 2>& priors_;
  const Elas::Parameters& parameters_;
  std::uint16_t floor_;
  std::array<std::vector<std::uint16_t>, 2> prior_energies_;
  std::array<std::vector<std::int16_t>, 2> expected_;
  std::array<std::vector<std::uint8_t>, 2> descriptors_; // of one row
  std::vector<std::int16_t> right_;                      // disparities of one row
};

namespace {

constexpr int steps = kernels::disparity_steps;
constexpr double max_energy = 8192.0; // well below that of no candidate

/** \brief -log(gamma + likeness) in units of a descriptor's distance, 0 at best. */
std::uint16_t
priorEnergy(const Elas::Parameters& parameters, double likeness)
{
  const double energy =
      std::log((parameters.gamma + 1.0) / (parameters.gamma + likeness)) /
      parameters.beta;
  return std::uint16_t(std::lround(std::min(energy, max_energy)));
}

/** \brief MatchRow::prior. */
std::vector<std::uint16_t>
priorEnergies(const Elas::Parameters& parameters, int direction)
{
  std::vector<std::uint16_t> energies;
  for (int fraction = 0; fraction < steps; ++fraction)
    for (int m = 0; m < 8; ++m) {
      const int position = (direction < 0 ? 7 - m : m) - 3;
      const double x = (position - double(fraction) / steps) / parameters.sigma;
      energies.push_back(std::abs(x) < 3.0
                             ? priorEnergy(parameters, std::exp(-0.5 * x * x))
                             : kernels::no_energy);
    }
  return energies;
}

} // namespace

BandMatcher::BandMatcher(const std::array<GradientImage, 2>& images,
                         const std::array<PlanePrior, 2>& priors,
                         const Elas::Parameters& parameters)
    : images_(images), priors_(priors), parameters_(parameters),
      floor_(priorEnergy(parameters, 0.0)),
      prior_energies_{priorEnergies(parameters, -1), priorEnergies(parameters, 1)},
      right_(std::size_t(images[0].width()))
{}

void
BandMatcher::match(int begin, int end, cv::Mat& disparity)
{
  for (std::size_t i = 0; i < 2; ++i)
    priors_[i].fillRows(begin, end, expected_[i]);
  for (int v = begin; v < end; ++v) {
    for (std::size_t i = 0; i < 2; ++i)
      images_[i].describeRow(v, descriptors_[i]);
    const std::size_t at = std::size_t(v - begin) * std::size_t(images_[0].width());
    std::int16_t* const row = disparity.ptr<std::int16_t>(v);
    matchRow(0, v, expected_[0].data() + at, row);
    matchRow(1, v, expected_[1].data() + at, right_.data());
    dropContradicted(row);
  }
}

void
BandMatcher::matchRow(std::size_t image, int v, const std::int16_t* expected,
                      std::int16_t* disparity)
{
  kernels::MatchRow row;
  row.own = GradientImage::firstPixel(descriptors_[image]);
  row.other = GradientImage::firstPixel(descriptors_[1 - image]);
  row.width = images_[0].width();
  row.disparities = parameters_.disparities;
  row.direction = image == 0 ? -1 : 1;
  row.plane = expected;
  row.seen = priors_[image].seen(v);
  row.cell_size = PlanePrior::cell_size;
  row.prior = prior_energies_[image].data();
  row.floor = floor_;
  kernels::mapDisparities(simdTier())(row, disparity);
}

void
BandMatcher::dropContradicted(std::int16_t* disparity) const
{
  const int tolerance = int(parameters_.left_right_tolerance * steps);
  for (int u = 0; u < images_[0].width(); ++u) {
    const int d = disparity[u], other = u - (d + steps / 2) / steps;
    if (d >= 0 && (other < 0 || right_[std::size_t(other)] < 0 ||
                   std::abs(right_[std::size_t(other)] - d) > tolerance))
      disparity[u] = kernels::no_disparity;
  }
}

namespace {

constexpr int band_rows = 16;
constexpr int largest_image = 16384; // the triangulation is exact up to here [px]

void
require(bool valid, const char* name, double value, const char* expected)
{
  if (!valid)
    PCL_THROW_EXCEPTION(InvalidParameterException, "ELAS: " << name << " is " << value
                                                            << ", expected "
                                                            << expected);
}

std::array<PlanePrior, 2>
makePriors(const std::vector<SupportPoint>& points, const cv::Size& size,
           int disparities)
{
  std::array<std::optional<PlanePrior>, 2> priors;
  ParallelGuard guard;
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < 2; ++i)
    guard.run([&] {
      priors[i].emplace(i == 0 ? points : seenFromRight(points), size.width,
                        size.height, disparities);
    });
  guard.rethrow();
  return {std::move(*priors[0]), std::move(*priors[1])};
}

cv::Mat
matchBands(const std::array<GradientImage, 2>& images,
           const std::array<PlanePrior, 2>& priors, const Elas::Parameters& parameters)
{
  const int rows = images[0].height();
  cv::Mat disparity(rows, images[0].width(), CV_16SC1);
  ParallelGuard guard;
#pragma omp parallel
  {
    std::optional<BandMatcher> matcher;
    guard.run([&] { matcher.emplace(images, priors, parameters); });
#pragma omp for schedule(dynamic)
    for (int begin = 0; begin < rows; begin += band_rows)
      guard.run([&] {
        if (matcher)
          matcher->match(begin, std::min(begin + band_rows, rows), disparity);
      });
  }
  guard.rethrow();
  return disparity;
}

} // namespace

void
Elas::Parameters::validate() const
{
  const auto within = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  require(disparities > 0 && disparities <= kernels::largest_disparities &&
              disparities % 16 == 0,
          "disparities", disparities, "a multiple of 16 up to 1024");
  require(within(support_step, 1, 25), "support_step", support_step, "1 to 25");
  require(within(support_texture, 0, 127), "support_texture", support_texture,
          "0 to 127");
  require(within(tau, 0.01, 1.0), "tau", tau, "0.01 to 1");
  require(within(support_tolerance, 0.0, 1024.0), "support_tolerance",
          support_tolerance, "0 to 1024");
  require(support_neighbours >= 0, "support_neighbours", support_neighbours,
          "0 or more");
  require(within(beta, 1e-3, 1e3), "beta", beta, "0.001 to 1000");
  require(within(gamma, 1e-6, 1e6), "gamma", gamma, "1e-6 to 1e6");
  // Eight disparities around the plane are looked at.
  require(within(sigma, 0.1, 1.0), "sigma", sigma, "0.1 to 1");
  require(within(left_right_tolerance, 0.0, 1024.0), "left_right_tolerance",
          left_right_tolerance, "0 to 1024");
  require(speckle_size >= 0, "speckle_size", speckle_size, "0 or more");
  require(within(speckle_range, 0.0, 1024.0), "speckle_range", speckle_range,
          "0 to 1024");
  require(within(smoothing_radius, 0, 16), "smoothing_radius", smoothing_radius,
          "0 to 16");
  require(within(smoothing_range, 0.0, 50.0), "smoothing_range", smoothing_range,
          "0 to 50");
  require(gap_width >= 0, "gap_width", gap_width, "0 or more");
  require(within(gap_step, 0.0, 1024.0), "gap_step", gap_step, "0 to 1024");
}

Elas::Elas(const Parameters& parameters) : parameters_(parameters)
{
  parameters_.validate();
}

DisparityImage
Elas::estimate(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  if (std::max(left.cols, left.rows) > largest_image)
    PCL_THROW_EXCEPTION(BadInputException, "left image is "
                                               << left.cols << " x " << left.rows
                                               << " pixels, expected at most "
                                               << largest_image << " across");
  const std::array<GradientImage, 2> images = {GradientImage(greyImage(left)),
                                               GradientImage(greyImage(right))};
  const std::vector<SupportPoint> points =
      findSupportPoints(images[0], images[1], parameters_);
  if (points.size() < 3) // nothing to go by
    return {cv::Mat(left.size(), CV_32FC1, cv::Scalar(0)),
            cv::Mat(left.size(), CV_32FC1, cv::Scalar(0))};
  const auto priors = makePriors(points, left.size(), parameters_.disparities);
  cv::Mat disparity = matchBands(images, priors, parameters_);
  removeSmallSegments(parameters_.speckle_size, int(parameters_.speckle_range * steps),
                      disparity);
  if (parameters_.smoothing_radius > 0)
    for (int pass = 0; pass < 2; ++pass)
      smoothDisparity(parameters_.smoothing_radius,
                      int(parameters_.smoothing_range * steps), disparity);
  return fillGaps(parameters_.gap_width, int(parameters_.gap_step * steps), disparity);
}

} // namespace pcl_semantic
