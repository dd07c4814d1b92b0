// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_estimator.h>

namespace pcl_semantic {

/** \brief Semi-global matching (H. Hirschmueller, Stereo processing by semiglobal
 * matching and mutual information, PAMI 2008) of census signatures (R. Zabih and J.
 * Woodfill, ECCV 1994) in blocks of 5 x 5 pixels, along three directions: from the
 * left, from the right, from above.
 *
 * Small segments are dropped, disparities smoothed and gaps filled as Elas does.
 * Colour images are matched as grey ones. The image is matched in bands of rows, whose
 * paths begin some rows above: the result does not depend on the number of threads nor
 * on the instruction set. */
class SemiGlobalMatcher : public DisparityEstimator {
public:
  struct Parameters {
    int disparities = 128; ///< largest disparity + 1 [px]; 64, 128, 192 or 256
    int small_step = 24;   ///< P1, in differing bits of a pixel's 31 x 25 / 16
    int large_step = 120;  ///< P2 where the image is smooth, else less, see edge
    int edge = 6;          ///< P2 falls from so many grey levels between pixels on
    int uniqueness = 5;    ///< the best sum has to beat the others by this [%]
    int left_right_tolerance = 1; ///< between the images' disparities [px]
    int speckle_size = 200;       ///< smaller segments are dropped [px]; 0 keeps all
    double speckle_range = 1.0;   ///< disparity step within a segment [px]
    int smoothing_radius = 5;     ///< along row and column [px]; 0 = none
    double smoothing_range = 4.0; ///< what differs by more does not count [px]
    int gap_width = 10000;        ///< longer gaps in a row stay [px]; 0 fills none
    double gap_step = 1.0;        ///< of the two ends of a gap [px], see fillGaps

    /** \throws InvalidParameterException that names the parameter and its range */
    void validate() const;
  };

  SemiGlobalMatcher() : SemiGlobalMatcher(Parameters()) {}

  /** \throws InvalidParameterException as Parameters::validate() */
  explicit SemiGlobalMatcher(const Parameters& parameters);

  DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) override;

private:
  Parameters parameters_;
};

} // namespace pcl_semantic
