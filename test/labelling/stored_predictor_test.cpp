// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/distribution_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <filesystem>
#include <fstream>

namespace pcl_semantic {
namespace {

namespace fs = std::filesystem;

constexpr int classes = 3;

class StoredPredictorTest : public ::testing::Test {
protected:
  void
  SetUp() override
  {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / (std::string("stored_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    frame_.number = 12;
    frame_.left = cv::Mat(2, 4, CV_8UC3, cv::Scalar(0));
  }

  void
  TearDown() override
  {
    fs::remove_all(folder_);
  }

  std::string
  file(const std::string& name) const
  {
    return (folder_ / name).string();
  }

  // What() of the exception, which has to name the folder.
  std::string
  refusal()
  {
    try {
      StoredPredictor(folder_.string(), classes, 0.7f).predict(frame_);
    }
    catch (const BadInputException& error) {
      EXPECT_NE(std::string(error.what()).find(folder_.string()), std::string::npos);
      return error.what();
    }
    ADD_FAILURE() << "accepted";
    return "";
  }

  fs::path folder_;
  StereoFrame frame_;
};

TEST_F(StoredPredictorTest, ReadsDistributions)
{
  LabelDistributions stored(classes, 8);
  for (int j = 0; j < 8; ++j)
    stored.setLabel(j, Label(j % 4), 0.5f);
  writeDistributions(file("000012.bin"), stored);
  writeDistributions(file("000013.bin"), LabelDistributions(classes, 8));
  StoredPredictor predictor(folder_.string(), classes, 0.7f);
  EXPECT_EQ(predictor.predict(frame_).matrix(), stored.matrix());
  frame_.number = 13;
  EXPECT_TRUE((predictor.predict(frame_).matrix().array() == 0.0f).all());
}

TEST_F(StoredPredictorTest, ReadsIdsWithTheStatedConfidence)
{
  cv::Mat ids(2, 4, CV_8UC1, cv::Scalar(0));
  ids.at<std::uint8_t>(1, 2) = 3;
  writePng(file("000012.png"), ids);
  const LabelDistributions labels =
      StoredPredictor(folder_.string(), classes, 0.7f).predict(frame_);
  ASSERT_EQ(labels.size(), 8);
  EXPECT_EQ(labels.mapLabel(0), kUnlabelled);
  EXPECT_FLOAT_EQ(labels.column(6)[2], 0.7f);
  EXPECT_FLOAT_EQ(labels.column(6)[0], 0.15f);
}

TEST_F(StoredPredictorTest, FrameWithoutFile)
{
  writeDistributions(file("000011.bin"), LabelDistributions(classes, 8));
  std::ofstream(file("000012.txt")) << "no labels";
  EXPECT_NE(refusal().find("frame 12"), std::string::npos);
}

TEST_F(StoredPredictorTest, FrameWithTwoFiles)
{
  writeDistributions(file("000012.bin"), LabelDistributions(classes, 8));
  writePng(file("000012.png"), cv::Mat(2, 4, CV_8UC1, cv::Scalar(1)));
  EXPECT_NE(refusal().find("frame 12"), std::string::npos);
}

TEST_F(StoredPredictorTest, FileOneByteShort)
{
  writeDistributions(file("000012.bin"), LabelDistributions(classes, 8));
  fs::resize_file(file("000012.bin"), classes * 8 * 4 - 1);
  EXPECT_NE(refusal().find("000012.bin"), std::string::npos);
}

TEST_F(StoredPredictorTest, FileOfAnotherImageSize)
{
  writePng(file("000012.png"), cv::Mat(4, 2, CV_8UC1, cv::Scalar(1)));
  EXPECT_NE(refusal().find("000012.png"), std::string::npos);
}

TEST_F(StoredPredictorTest, FramesWithoutAFileAreFoundBeforeTheWork)
{
  writePng(file("000012.png"), cv::Mat(2, 4, CV_8UC1, cv::Scalar(1)));
  const StoredPredictor predictor(folder_.string(), classes, 0.7f);
  EXPECT_NO_THROW(predictor.requireFrames({12}));
  EXPECT_THROW(predictor.requireFrames({12, 13}), BadInputException);
}

TEST_F(StoredPredictorTest, RefusesWrongArguments)
{
  const std::string folder = folder_.string();
  EXPECT_THROW(StoredPredictor(folder + "/none", 3, 0.5f), BadInputException);
  EXPECT_THROW(StoredPredictor(folder, 0, 0.5f), InvalidParameterException);
  EXPECT_THROW(StoredPredictor(folder, 256, 0.5f), InvalidParameterException);
  EXPECT_THROW(StoredPredictor(folder, 3, 0.0f), InvalidParameterException);
  EXPECT_THROW(StoredPredictor(folder, 3, 1.5f), InvalidParameterException);
  EXPECT_THROW(StoredPredictor(folder, 3, std::nanf("")), InvalidParameterException);
}

} // namespace
} // namespace pcl_semantic
