// SPDX-License-Identifier: BSD-3-Clause
#include "band_matcher.h"

#include "kernels/map_disparity.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace pcl_semantic {

namespace {

constexpr int steps = kernels::disparity_steps;
constexpr double largest_energy = 8192.0; // well below that of no candidate

/** \brief -log(gamma + likeness) in units of a descriptor's distance, 0 at best. */
std::uint16_t
priorEnergy(const Elas::Parameters& parameters, double likeness)
{
  const double energy =
      std::log((parameters.gamma + 1.0) / (parameters.gamma + likeness)) /
      parameters.beta;
  return std::uint16_t(std::lround(std::min(energy, largest_energy)));
}

/** \brief MatchRow::prior. */
std::vector<std::uint16_t>
priorEnergies(const Elas::Parameters& parameters, int direction)
{
  std::vector<std::uint16_t> energies;
  for (int fraction = 0; fraction < steps; ++fraction)
    for (int m = 0; m < 8; ++m) {
      const int place = (direction < 0 ? 7 - m : m) - 3;
      const double x = (place - double(fraction) / steps) / parameters.sigma;
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

} // namespace pcl_semantic
