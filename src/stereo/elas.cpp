// SPDX-License-Identifier: BSD-3-Clause
#include "elas.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "disparity_cleaning.h"
#include "image_pair.h"
#include "images/grey_image.h"
#include "kernels/elas_loops.h"
#include "parallel_bands.h"
#include "plane_prior.h"
#include "support_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

namespace pcl_semantic {

namespace {

// Names from the paper; values tuned for these gradients on KITTI.
constexpr double beta = 0.06; // weight per grey level of gradient
constexpr double gamma = 0.5; // fraction of pixels far from the plane
constexpr double sigma = 1.0; // of the prior around the plane [px]

constexpr int steps = kernels::disparity_steps;
constexpr double max_energy = 8192.0;   // well below no_energy
constexpr int left_right_tolerance = 9; // 0.6 px [1 / steps px]
constexpr int smoothing_rounds = 2;
constexpr int gap_step = 6; // [px]
constexpr int band_rows = 16;
constexpr int largest_image = 16384; // up to here the triangulation is exact [px]

using Images = std::array<GradientImage, 2>;
using Priors = std::array<PlanePrior, 2>;

/** \brief -log(gamma + likelihood) in units of a descriptor's distance, minimum 0. */
std::uint16_t
priorEnergy(double likeness)
{
  const double energy = std::log((gamma + 1.0) / (gamma + likeness)) / beta;
  return std::uint16_t(std::lround(std::min(energy, max_energy)));
}

/** \brief MatchRow::prior. */
std::vector<std::uint16_t>
priorEnergies(int direction)
{
  std::vector<std::uint16_t> energies;
  for (int fraction = 0; fraction < steps; ++fraction)
    for (int m = 0; m < 8; ++m) {
      const int position = (direction < 0 ? 7 - m : m) - 3;
      const double x = (position - double(fraction) / steps) / sigma;
      energies.push_back(std::abs(x) < 3.0 ? priorEnergy(std::exp(-0.5 * x * x))
                                           : kernels::no_energy);
    }
  return energies;
}

/** \brief Matches rows of two images in both directions; one per thread. Refers to its
 * arguments. */
class BandMatcher {
public:
  BandMatcher(const Images& images, const Priors& priors, int disparities)
      : images_(images), priors_(priors), disparities_(disparities),
        right_(std::size_t(images[0].width()))
  {}

  /** \brief Disparities of rows [begin, end) of the left image that pass the left-right
   * check (CV_16SC1, [1 / disparity_steps px], no_disparity = none). */
  void
  match(int begin, int end, cv::Mat& disparity)
  {
    for (std::size_t i = 0; i < 2; ++i)
      priors_[i].fillRows(begin, end, expected_[i]);
    for (int v = begin; v < end; ++v) {
      for (std::size_t i = 0; i < 2; ++i)
        images_[i].describeRow(v, descriptors_[i]);
      const std::size_t at = std::size_t(v - begin) * right_.size();
      std::int16_t* const row = disparity.ptr<std::int16_t>(v);
      matchRow(0, v, expected_[0].data() + at, row);
      matchRow(1, v, expected_[1].data() + at, right_.data());
      dropContradicted(row);
    }
  }

private:
  void
  matchRow(std::size_t image, int v, const std::int16_t* expected,
           std::int16_t* disparity)
  {
    kernels::MatchRow row;
    row.own = GradientImage::firstPixel(descriptors_[image]);
    row.other = GradientImage::firstPixel(descriptors_[1 - image]);
    row.width = int(right_.size());
    row.disparities = disparities_;
    row.direction = image == 0 ? -1 : 1;
    row.plane = expected;
    row.seen = priors_[image].seen(v);
    row.cell_size = PlanePrior::cell_size;
    row.prior = prior_energies_[image].data();
    row.floor = floor_;
    loops_.match(row, disparity);
  }

  void
  dropContradicted(std::int16_t* disparity) const
  {
    for (int u = 0; u < int(right_.size()); ++u) {
      const int d = disparity[u], other = u - (d + steps / 2) / steps;
      if (d >= 0 && (other < 0 || right_[std::size_t(other)] < 0 ||
                     std::abs(right_[std::size_t(other)] - d) > left_right_tolerance))
        disparity[u] = kernels::no_disparity;
    }
  }

  const Images& images_;
  const Priors& priors_;
  const int disparities_;
  const kernels::ElasLoops& loops_ = kernels::elasLoops(simdTier());
  const std::uint16_t floor_ = priorEnergy(0.0);
  const std::array<std::vector<std::uint16_t>, 2> prior_energies_{priorEnergies(-1),
                                                                  priorEnergies(1)};
  std::array<std::vector<std::int16_t>, 2> expected_;
  std::array<std::vector<std::uint8_t>, 2> descriptors_; // of one row
  std::vector<std::int16_t> right_;                      // disparities of one row
};

Priors
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

} // namespace

DisparityImage
Elas::estimate(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  if (std::max(left.cols, left.rows) > largest_image)
    badInput("left image is ", left.cols, " x ", left.rows,
             " pixels, expected at most ", largest_image, " across");
  const Images images = {GradientImage(greyImage(left)),
                         GradientImage(greyImage(right))};
  const std::vector<SupportPoint> points =
      findSupportPoints(images[0], images[1], disparities_);
  if (points.size() < 3) // too few for a triangle
    return {cv::Mat1f(left.size(), 0.0f), cv::Mat1f(left.size(), 0.0f)};
  const Priors priors = makePriors(points, left.size(), disparities_);
  cv::Mat disparity(left.size(), CV_16SC1);
  forBandsOfRows(
      left.rows, band_rows, [&] { return BandMatcher(images, priors, disparities_); },
      [&](BandMatcher& matcher, int begin, int end) {
        matcher.match(begin, end, disparity);
      });
  return cleanDisparity(smoothing_rounds, gap_step, disparity);
}

} // namespace pcl_semantic
