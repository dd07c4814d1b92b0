// SPDX-License-Identifier: BSD-3-Clause
#include "support/toy_tuning.h"

#include <pcl_semantic/pipeline/tuning_report.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

// The rows of the highest pixel of a colour at each candidate of the first panel.
std::vector<int>
heights(const cv::Mat& picture, std::size_t candidates, const cv::Vec3b& colour)
{
  std::vector<int> rows;
  for (std::size_t i = 0; i < candidates; ++i) {
    const int column = 62 + int((double(i) + 0.5) / double(candidates) * 340.0);
    int row = 44; // below the legend
    while (row < 344 && picture.at<cv::Vec3b>(row, column) != colour)
      ++row;
    rows.push_back(row);
  }
  return rows;
}

} // namespace

TEST(SensitivityPicture, HigherScoresAreHigher)
{
  // The same on all streets: held out, drawn last, is what all have.
  ToyTuning toy([](double a, double b, std::size_t) {
    return int(500 + 100 * a - 30 * a * a + 10 * b); // 0 to 4: 500 570 580 530 420
  });
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  ASSERT_TRUE(tuner.search());
  const cv::Mat picture = drawSensitivity(tuner);
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_EQ(picture.size(), cv::Size(840, 344)) << "two panels and the legend";
  const std::vector<int> rows = heights(picture, 5, {30, 120, 235});
  EXPECT_LT(rows[2], rows[1]);
  EXPECT_LT(rows[1], rows[3]);
  EXPECT_LT(rows[3], rows[0]);
  EXPECT_LT(rows[0], rows[4]);
  EXPECT_LT(rows[4], 344) << "drawn at all";
  // In proportion: 160 of 1000 pixels from the highest to the lowest, 10 to the next.
  EXPECT_NEAR(double(rows[1] - rows[2]) / double(rows[4] - rows[2]), 10.0 / 160.0,
              0.02);
}

TEST(SensitivityPicture, ManyParametersAndFlatScores)
{
  ToyTuning toy([](double, double, std::size_t) { return 700; });
  toy.grid.axes.push_back({"crf", {"dense", "none"}, 0, false});
  toy.grid.axes.push_back({"voxel_size", {"0.1", "0.2"}, 0, true});
  TuningStore store("", "", 2);
  Tuner tuner = toy.make(store);
  ASSERT_TRUE(tuner.search());
  EXPECT_EQ(tuner.chosen(), toy.grid.startChoice());
  EXPECT_EQ(drawSensitivity(tuner).size(), cv::Size(3 * 420, 44 + 2 * 300));
}

} // namespace pcl_semantic
