// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <filesystem>

namespace pcl_semantic {
namespace {

constexpr int classes = 3;

class StoredPredictorTest : public ::testing::Test {
protected:
  StoredPredictorTest() {}

  StoredPredictor
  predictor() const
  {
    return {folder_.path(), classes, 0.7f};
  }

  void
  writeUnlabelled(const std::string& name) const
  {
    writeDistributions(folder_.path(name), LabelDistributions(classes, 8));
  }

  void
  writeOnes(const std::string& name, int rows, int columns) const
  {
    writePng(folder_.path(name), cv::Mat(rows, columns, CV_8UC1, cv::Scalar(1)));
  }

  // The message names the folder and \a part.
  void
  expectRefused(const std::string& part) const
  {
    const std::string message =
        thrownMessage<BadInputException>([&] { predictor().predict(image_, number_); });
    EXPECT_TRUE(holds(message, folder_.path()));
    EXPECT_TRUE(holds(message, part));
  }

  TemporaryFolder folder_;
  cv::Mat image_ = cv::Mat(2, 4, CV_8UC3, cv::Scalar(0));
  int number_ = 12;
};

TEST_F(StoredPredictorTest, ReadsDistributions)
{
  LabelDistributions stored(classes, 8);
  for (int j = 0; j < 8; ++j)
    stored.setLabel(j, Label(j % 4), 0.5f);
  writeDistributions(folder_.path("000012.bin"), stored);
  writeUnlabelled("000013.bin");
  EXPECT_EQ(predictor().predict(image_, number_).matrix(), stored.matrix());
  number_ = 13;
  EXPECT_TRUE((predictor().predict(image_, number_).matrix().array() == 0.0f).all());
}

TEST_F(StoredPredictorTest, ReadsIdsWithTheStatedConfidence)
{
  cv::Mat ids(2, 4, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(1, 2) = 3;
  writePng(folder_.path("000012.png"), ids);
  const LabelDistributions labels = predictor().predict(image_, number_);
  ASSERT_EQ(labels.size(), 8);
  EXPECT_EQ(labels.mapLabel(0), kUnlabelled);
  EXPECT_FLOAT_EQ(labels.column(6)[2], 0.7f);
  EXPECT_FLOAT_EQ(labels.column(6)[0], 0.15f);
}

TEST_F(StoredPredictorTest, RefusesFilesThatAreNotTheFrames)
{
  writeUnlabelled("000011.bin");
  folder_.write("000012.txt", "no labels");
  expectRefused("frame 12 has no labels");
  writeUnlabelled("000012.bin");
  writeOnes("000012.png", 2, 4);
  expectRefused("frame 12 has two files");
  std::filesystem::remove(folder_.path("000012.png"));
  std::filesystem::resize_file(folder_.path("000012.bin"), classes * 8 * 4 - 1);
  expectRefused("000012.bin");
  std::filesystem::remove(folder_.path("000012.bin"));
  writeOnes("000012.png", 4, 2);
  expectRefused("000012.png");
}

TEST_F(StoredPredictorTest, FramesWithoutAFileAreFoundBeforeTheWork)
{
  writeOnes("000012.png", 2, 4);
  EXPECT_NO_THROW(predictor().requireFrames({12}));
  EXPECT_THROW(predictor().requireFrames({12, 13}), BadInputException);
}

TEST_F(StoredPredictorTest, RefusesWrongArguments)
{
  EXPECT_THROW(StoredPredictor(folder_.path("none"), 3, 0.5f), BadInputException);
  for (const int number : {0, 256})
    EXPECT_THROW(StoredPredictor(folder_.path(), number, 0.5f),
                 InvalidParameterException);
  for (const float confidence : {0.0f, 1.5f, std::nanf("")})
    EXPECT_THROW(StoredPredictor(folder_.path(), 3, confidence),
                 InvalidParameterException);
}

} // namespace
} // namespace pcl_semantic
