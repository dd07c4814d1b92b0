// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gradient_image.h"
#include "plane_prior.h"

#include <pcl_semantic/stereo/elas.h>

#include <opencv2/core/mat.hpp>

#include <array>
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

} // namespace pcl_semantic
