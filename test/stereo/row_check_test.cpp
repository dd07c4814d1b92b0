// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/renderer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/stereo/row_check.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

namespace {

cv::Mat
turned(const cv::Mat& image, double degrees, double down)
{
  cv::Mat turn = cv::getRotationMatrix2D(
      {0.5f * float(image.cols), 0.5f * float(image.rows)}, degrees, 1.0);
  turn.at<double>(1, 2) += down;
  cv::Mat result;
  cv::warpAffine(image, result, turn, image.size(), cv::INTER_CUBIC,
                 cv::BORDER_REFLECT);
  return result;
}

} // namespace

TEST(RowCheck, MeasuresTheDifferenceOfRows)
{
  for (const unsigned seed : {1u, 2u, 3u}) {
    const SyntheticView view =
        SyntheticRenderer(SyntheticScene(seed), 620, 188).render(4);
    const RowCheck good = checkRows(view.left, view.right);
    EXPECT_GE(good.matches, 30);
    EXPECT_LT(good.median, 0.25);
    EXPECT_FALSE(good.isDoubtful());
    const RowCheck lower = checkRows(view.left, turned(view.right, 0.0, 2.5));
    EXPECT_NEAR(lower.median, 2.5, 0.25);
    EXPECT_TRUE(lower.isDoubtful());
    EXPECT_TRUE(checkRows(view.left, turned(view.right, 1.0, 0.0)).isDoubtful());
  }
}

TEST(RowCheck, SaysNothingWithoutCorners)
{
  const cv::Mat blank(188, 620, CV_8UC3, cv::Scalar::all(90));
  EXPECT_EQ(checkRows(blank, blank).matches, 0);
  const cv::Mat tiny(12, 20, CV_8UC1, cv::Scalar(3));
  EXPECT_FALSE(checkRows(tiny, tiny).isSure());
  EXPECT_THROW(checkRows(blank, tiny), BadInputException);
}

} // namespace pcl_semantic
