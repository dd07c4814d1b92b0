// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

using namespace pcl_semantic;

TEST(SmallPng, IsNearlyThePictureAndSmaller)
{
  const TemporaryFolder folder;
  cv::Mat picture(120, 160, CV_8UC3);
  cv::RNG random(1);
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  writePng(folder.path("a.png"), picture);
  writeSmallPng(folder.path("b.png"), picture);
  const cv::Mat read = readPng(folder.path("b.png"), ImageKind::grey_or_colour);
  ASSERT_EQ(read.size(), picture.size());
  EXPECT_LE(cv::norm(read, picture, cv::NORM_INF), 4.0);
  EXPECT_LT(std::filesystem::file_size(folder.path("b.png")) * 10,
            std::filesystem::file_size(folder.path("a.png")) * 8);
}

TEST(SmallPng, RefusesWhatIsNoPicture)
{
  const TemporaryFolder folder;
  EXPECT_THROW(writeSmallPng(folder.path("a.png"), cv::Mat::ones(4, 4, CV_8UC1)),
               InvalidParameterException);
  EXPECT_THROW(writeSmallPng(folder.path("none/a.png"), cv::Mat::ones(4, 4, CV_8UC3)),
               OutputException);
  EXPECT_EQ(folder.entries(), 0u);
}
