// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/cloud_sequence.h>
#include <pcl_semantic/files/cloud_file.h>

#include <gtest/gtest.h>

#include <filesystem>

namespace pcl_semantic {

namespace {

const std::string two_points =
    asciiCloud("x y z label", "1 2 3 2\nnan nan nan 0\n", 1, "0 0 0 1 0 0 0");

} // namespace

TEST(CloudSequence, NumbersAndTimesAreThoseOfTheNames)
{
  struct Frame {
    std::string name;
    int number;
    double time;
  };
  using Frames = std::vector<Frame>;
  for (const Frames& expected :
       {Frames{{"000002", 2, 0.2}, {"7", 7, 0.7}, {"10", 10, 1.0}},
        Frames{{"3", 0, 0.0}, {"shot9", 1, 0.1}, {"shot10", 2, 0.2}}, // are counted
        Frames{{"99.75", 0, 99.75}, {"100.25", 1, 100.25}, {"100.5", 2, 100.5}},
        Frames{{"1403636579763555584", 0, 1403636579.763555584}}}) {
    const TemporaryFolder folder;
    folder.write("poses.txt", "");
    for (const Frame& frame : expected)
      folder.write(frame.name + ".pcd", two_points);
    for (const char* const pattern : {"", "*.pcd"}) {
      const CloudSequence clouds(folder.path(pattern));
      ASSERT_EQ(clouds.size(), expected.size());
      for (std::size_t i = 0; i < clouds.size(); ++i) {
        const auto& [name, number, time] = expected[i];
        EXPECT_EQ(std::filesystem::path(clouds.path(i)).stem(), name);
        EXPECT_EQ(clouds.frameNumber(i), number) << name;
        EXPECT_NEAR(clouds.timestamp(i), time, 1e-6) << name;
      }
    }
  }
}

TEST(CloudSequence, TimesOfAFileAreThoseOfTheFrames)
{
  const TemporaryFolder folder;
  folder.write("000001.pcd", two_points);
  folder.write("000003.pcd", two_points);
  folder.write("times.txt", "0\n1.5\n2\n4.5\n");
  const CloudSequence clouds(folder.path(), folder.path("times.txt"));
  EXPECT_DOUBLE_EQ(clouds.timestamp(0), 1.5);
  EXPECT_DOUBLE_EQ(clouds.timestamp(1), 4.5);
  folder.write("times.txt", "0\n1.5\n2\n");
  EXPECT_EQ(thrownMessage<BadInputException>(
                [&] { CloudSequence(folder.path(), folder.path("times.txt")); }),
            folder.path("times.txt") +
                ": has 3 times, but frame 3 is there (row = frame number)");
}

TEST(CloudSequence, LabelsBecomeDistributions)
{
  const TemporaryFolder folder;
  folder.write("0.pcd", two_points);
  const CloudFrame frame = CloudSequence(folder.path()).frame(0, 3, 0.8f);
  EXPECT_FALSE(frame.has_colour);
  EXPECT_FLOAT_EQ((*frame.cloud)[0].z, 3.0f);
  ASSERT_EQ(frame.distributions.size(), 2);
  EXPECT_FLOAT_EQ(frame.distributions.column(0)[1], 0.8f);
  EXPECT_FLOAT_EQ(frame.distributions.column(0)[2], 0.1f);
  EXPECT_EQ(frame.distributions.mapLabel(1), kUnlabelled);
}

TEST(CloudSequence, ProbabilitiesAreTakenToTheBit)
{
  const TemporaryFolder folder;
  LabelledCloud cloud;
  cloud.cloud->resize(1000);
  LabelDistributions::Matrix weights =
      LabelDistributions::Matrix::Random(7, 1000).cwiseAbs();
  cloud.distributions = LabelDistributions(std::move(weights));
  cloud.has_colour = true;
  writeLabelledCloud(folder.path("0.pcd"), cloud);
  const CloudFrame frame = CloudSequence(folder.path()).frame(0, 7, 0.8f);
  EXPECT_TRUE(frame.has_colour);
  EXPECT_TRUE(frame.distributions.matrix() == cloud.distributions.matrix());
}

TEST(CloudSequence, WhatDoesNotFitIsRefused)
{
  const TemporaryFolder folder;
  EXPECT_THROW(CloudSequence(folder.path()), BadInputException);
  folder.write("1.pcd", two_points);
  const CloudSequence clouds(folder.path());
  EXPECT_EQ(thrownMessage<BadInputException>([&] { clouds.frame(0, 1, 0.8f); }),
            folder.path("1.pcd") +
                ": point 0 has label 2, expected 0 to 1, or a label mapping");
  EXPECT_EQ(thrownMessage<InvalidParameterException>([&] { clouds.frame(5, 7, 0.8f); }),
            "frame 5 is beyond the 1 of the sequence");
  folder.write("01.pcd", two_points);
  EXPECT_THROW(CloudSequence(folder.path()), BadInputException);
}

} // namespace pcl_semantic
