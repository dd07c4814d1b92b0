// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_estimator.h>

#include <memory>

namespace cv {
class StereoSGBM;
}

namespace pcl_semantic {

/** \brief Semi-global matching (H. Hirschmueller, Stereo processing by semiglobal
 * matching and mutual information, PAMI 2008) as OpenCV implements it.
 *
 * The images are padded on the left by the number of disparities, so that the first
 * columns are matched too; a match outside the right image is no match. Colour images
 * are matched as grey ones: on KITTI that is as good and takes half the time. The
 * deviation is the same for all pixels. The result does not depend on the number of
 * threads. Not for use from several threads at once. */
class Sgbm : public DisparityEstimator {
public:
  /** \brief Along how many directions the cost is summed up. */
  enum class Mode {
    three_way, ///< 3 directions: the fastest
    five_way,  ///< 5 directions in one pass
    eight_way  ///< 8 directions in two passes: keeps the costs of the whole image
  };

  struct Parameters {
    Mode mode = Mode::three_way;
    int disparities = 128;       ///< largest disparity + 1 [px]; a multiple of 16
    int block_size = 5;          ///< edge of the compared window [px]; odd
    int small_step_penalty = 16; ///< P1 per pixel of the window, for steps of 1 px
    int large_step_penalty = 64; ///< P2 per pixel of the window, for larger steps; > P1
    int left_right_tolerance =
        1;                  ///< of the consistency check [px]; negative = no check
    int uniqueness = 10;    ///< the best cost has to beat the others by this [%]
    int gradient_cap = 63;  ///< gradients are compared up to this
    int speckle_size = 200; ///< smaller regions are dropped [px]; 0 keeps all
    int speckle_range = 2;  ///< disparity step within a region [px]

    /** \throws InvalidParameterException that names the parameter and its range */
    void validate() const;
  };

  Sgbm() : Sgbm(Parameters()) {}

  /** \throws InvalidParameterException as Parameters::validate() */
  explicit Sgbm(const Parameters& parameters);

  const Parameters&
  parameters() const
  {
    return parameters_;
  }

  DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) override;

private:
  Parameters parameters_;
  std::shared_ptr<cv::StereoSGBM> matcher_;
};

} // namespace pcl_semantic
