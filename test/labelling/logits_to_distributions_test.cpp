// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/labelling/logits_to_distributions.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <limits>

namespace pcl_semantic {
namespace {

cv::Mat
makeLogits(int channels, int height, int width, double deviation)
{
  const int shape[] = {channels, height, width};
  cv::Mat logits(3, shape, CV_32FC1);
  cv::Mat rows = logits.reshape(1, channels);
  cv::RNG(5).fill(rows, cv::RNG::NORMAL, 0.0, deviation);
  return logits;
}

// Resized by OpenCV, then pixel by pixel in double precision, as it is written down.
Eigen::MatrixXd
plain(const cv::Mat& logits, const cv::Size& size, const ChannelClasses& channels)
{
  const int count = logits.size[0];
  std::vector<cv::Mat> planes(count);
  for (int c = 0; c < count; ++c) {
    const cv::Mat plane(logits.size[1], logits.size[2], CV_32FC1,
                        const_cast<float*>(logits.ptr<float>(c)));
    cv::resize(plane, planes[c], size, 0.0, 0.0, cv::INTER_LINEAR);
  }
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(channels.classes, size.area());
  for (int j = 0; j < size.area(); ++j) {
    double total = 0.0, kept = 0.0;
    for (int c = 0; c < count; ++c) {
      const double value = planes[c].ptr<float>(j / size.width)[j % size.width];
      const double mass = channels.softmax ? std::exp(value) : value;
      total += mass;
      if (channels.labels[c] == kUnlabelled)
        continue;
      kept += mass;
      result(channels.labels[c] - 1, j) += mass;
    }
    if (kept < 0.5 * total)
      result.col(j).setZero();
    else
      result.col(j) /= kept;
  }
  return result;
}

double
largestDifference(const LabelDistributions& a, const Eigen::MatrixXd& b)
{
  return (a.matrix().cast<double>() - b).cwiseAbs().maxCoeff();
}

TEST(LogitsToDistributions, EqualsThePlainComputation)
{
  const cv::Mat logits = makeLogits(6, 12, 20, 3.0);
  const ChannelClasses channels{{2, 1, 0, 2, 4, 0}, 4, true};
  for (const cv::Size size : {cv::Size(20, 12), cv::Size(51, 29), cv::Size(33, 10)}) {
    const LabelDistributions result = distributionsFromLogits(logits, size, channels);
    ASSERT_EQ(result.classes(), 4);
    ASSERT_EQ(result.size(), size.area());
    EXPECT_LT(largestDifference(result, plain(logits, size, channels)), 2e-5)
        << size.width << " x " << size.height;
    const auto sums = result.matrix().colwise().sum();
    int unlabelled = 0;
    for (int j = 0; j < size.area(); ++j) {
      unlabelled += sums[j] == 0.0f;
      EXPECT_TRUE(sums[j] == 0.0f || std::abs(sums[j] - 1.0f) < 1e-5f) << sums[j];
    }
    EXPECT_GT(unlabelled, size.area() / 20) << "both sides of the rule are tried";
    EXPECT_LT(unlabelled, size.area() / 2);
  }
  // Probabilities are taken as they are.
  const cv::Mat values = cv::abs(makeLogits(4, 5, 6, 1.0));
  const ChannelClasses given{{3, 1, 3, 0}, 3, false};
  EXPECT_LT(largestDifference(distributionsFromLogits(values, cv::Size(11, 9), given),
                              plain(values, cv::Size(11, 9), given)),
            2e-6);
}

TEST(LogitsToDistributions, HalfOfTheMassHasToBeLeft)
{
  const int shape[] = {2, 1, 3};
  const float probabilities[] = {0.5f, 0.49f, 0.0f, 0.5f, 0.51f, 0.0f};
  const cv::Mat values(3, shape, CV_32FC1, const_cast<float*>(probabilities));
  const ChannelClasses channels{{1, 0}, 1, false};
  const LabelDistributions result =
      distributionsFromLogits(values, cv::Size(3, 1), channels);
  EXPECT_EQ(result.matrix()(0, 0), 1.0f) << "exactly half";
  EXPECT_EQ(result.matrix()(0, 1), 0.0f) << "less than half";
  EXPECT_EQ(result.matrix()(0, 2), 0.0f) << "nothing at all";
}

TEST(LogitsToDistributions, WhatIsNoProbabilityIsRefused)
{
  const ChannelClasses logits{{1, 2, 3}, 3, true}, probabilities{{1, 2, 3}, 3, false};
  for (const float bad :
       {-0.5f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    const int shape[] = {3, 4, 5};
    cv::Mat values(3, shape, CV_32FC1, cv::Scalar(0.25));
    values.at<float>(1, 2, 3) = bad;
    for (const ChannelClasses& channels : {logits, probabilities}) {
      const auto convert = [&] {
        distributionsFromLogits(values, cv::Size(5, 4), channels);
      };
      if (channels.softmax && bad == -0.5f)
        convert();
      else
        expectBadInput("channel 1, row 2, column 3", convert);
    }
  }
}

TEST(LogitsToDistributions, LargeLogitsDoNotOverflow)
{
  const cv::Mat logits = makeLogits(3, 4, 4, 1e30);
  const LabelDistributions result = distributionsFromLogits(
      logits, cv::Size(8, 8), ChannelClasses{{1, 2, 3}, 3, true});
  EXPECT_TRUE(result.matrix().allFinite());
  EXPECT_TRUE(((result.matrix().colwise().sum().array() - 1.0f).abs() < 1e-6f).all());
}

TEST(LogitsToDistributions, SameForAnyNumberOfThreads)
{
  const cv::Mat logits = makeLogits(5, 17, 23, 2.0);
  const ChannelClasses channels{{1, 2, 3, 0, 2}, 3, true};
  setNumberOfThreads(1);
  const LabelDistributions single =
      distributionsFromLogits(logits, cv::Size(61, 45), channels);
  for (const int threads : {0, 2, 3, 64}) {
    setNumberOfThreads(threads);
    EXPECT_EQ(distributionsFromLogits(logits, cv::Size(61, 45), channels).matrix(),
              single.matrix());
  }
  setNumberOfThreads(0);
}

TEST(LogitsToDistributions, RefusesWhatDoesNotFit)
{
  const cv::Mat logits = makeLogits(2, 4, 4, 1.0);
  const ChannelClasses channels{{1, 2}, 2, true};
  const auto refused = [](const cv::Mat& values, cv::Size size,
                          const ChannelClasses& c) {
    EXPECT_THROW(distributionsFromLogits(values, size, c), InvalidParameterException);
  };
  refused(cv::Mat(), cv::Size(4, 4), channels);
  refused(cv::Mat(4, 4, CV_32FC1, cv::Scalar(0)), cv::Size(4, 4), channels);
  refused(logits, cv::Size(0, 4), channels);
  refused(logits, cv::Size(4, 4), ChannelClasses{{1, 2, 1}, 2, true});
  refused(logits, cv::Size(4, 4), ChannelClasses{{1, 3}, 2, true});
}

} // namespace
} // namespace pcl_semantic
