// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/stereo/pair_check.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cstdlib>

namespace pcl_semantic {

void
PrintTo(PairFault fault, std::ostream* stream)
{
  const char* const names[] = {"none", "blank", "identical", "swapped", "unrelated"};
  *stream << names[int(fault)];
}

namespace {

struct Pair {
  cv::Mat left, right;
};

Pair
street(std::uint32_t seed, int frame, int width = 620, int height = 188)
{
  const SyntheticView view =
      SyntheticRenderer(SyntheticScene(seed), width, height).render(frame);
  return {view.left, view.right};
}

PairFault
faultOf(const cv::Mat& left, const cv::Mat& right)
{
  return checkPair(left, right).fault;
}

cv::Mat
noise(int width, int height, double mean, double deviation, int seed = 1)
{
  cv::Mat image(height, width, CV_8UC1);
  cv::RNG(std::uint64_t(seed)).fill(image, cv::RNG::NORMAL, mean, deviation);
  return image;
}

// Columns d to d + 620 of a texture: the content of the left image is d pixels farther
// to the right than in the right image.
Pair
shifted(const cv::Mat& texture, int d)
{
  return {texture.colRange(200 - d, 820 - d).clone(),
          texture.colRange(200, 820).clone()};
}

cv::Mat
mirrored(const cv::Mat& image)
{
  cv::Mat result;
  cv::flip(image, result, 1);
  return result;
}

cv::Mat
periodic(int period_u, int period_v, double deviation)
{
  cv::Mat image = noise(1020, 188, 128.0, deviation);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const bool is_light =
          (u % period_u < period_u / 2) != (v % period_v < period_v / 2);
      std::uint8_t& pixel = image.at<std::uint8_t>(v, u);
      pixel = cv::saturate_cast<std::uint8_t>(pixel + (is_light ? 60 : -60));
    }
  return image;
}

} // namespace

TEST(PairCheck, TellsSwappedStreetsFromGoodOnes)
{
  for (const std::uint32_t seed : {1u, 2u, 3u})
    for (const int frame : {0, 39}) {
      const Pair pair = street(seed, frame, 208, 64);
      EXPECT_EQ(faultOf(pair.left, pair.right), PairFault::none);
      EXPECT_EQ(faultOf(pair.right, pair.left), PairFault::swapped);
      EXPECT_EQ(faultOf(mirrored(pair.left), mirrored(pair.right)), PairFault::swapped);
    }
}

TEST(PairCheck, DoesNotDependOnSizeColourOrBrightness)
{
  for (const auto& [width, height] : {std::pair(620, 188), {320, 100}, {208, 64}}) {
    Pair pair = street(5, 3, width, height);
    cv::cvtColor(pair.left, pair.left, cv::COLOR_BGR2GRAY);
    cv::cvtColor(pair.right, pair.right, cv::COLOR_BGR2GRAY);
    pair.left = 0.5 * pair.left + 30;
    pair.right = 0.5 * pair.right + 70;
    EXPECT_EQ(faultOf(pair.left, pair.right), PairFault::none) << width;
    EXPECT_EQ(faultOf(pair.right, pair.left), PairFault::swapped) << width;
  }
}

TEST(PairCheck, FindsMatchesOnTheirSideUnlessTheyAreFar)
{
  const cv::Mat texture = noise(1020, 188, 128.0, 50.0);
  for (const int d : {1, 2, 10, 77}) {
    const Pair pair = shifted(texture, d), swapped = shifted(texture, -d);
    EXPECT_EQ(faultOf(pair.left, pair.right), PairFault::none);
    EXPECT_EQ(checkPair(swapped.left, swapped.right).reason,
              d == 1 ? ""
                     : "left and right are swapped: of 200 positions found in both, "
                       "200 lie further right in the right image");
  }
}

TEST(PairCheck, RepeatedTextureIsNoEvidence)
{
  for (const int period : {6, 12, 20, 40})
    for (const int period_v : {10, 1000})
      for (const double deviation : {0.0, 2.0, 6.0})
        for (const int d : {3, period - 1, period / 2 + 1, 33}) {
          // Each camera has its own noise.
          Pair pair = shifted(periodic(period, period_v, 0.0), d);
          pair.left += noise(620, 188, 10.0, deviation, 2);
          pair.right += noise(620, 188, 10.0, deviation, 3);
          for (const PairFault fault :
               {faultOf(pair.left, pair.right), faultOf(pair.right, pair.left)})
            EXPECT_TRUE(fault == PairFault::none ||
                        (fault == PairFault::identical && d % period == 0))
                << period << " " << period_v << " " << deviation << " " << d << " "
                << testing::PrintToString(fault);
        }
}

TEST(PairCheck, NamesTheBlankSide)
{
  const Pair pair = street(1, 0, 208, 64);
  const auto grey = [](const cv::Mat& image) {
    cv::Mat result;
    cv::cvtColor(image, result, cv::COLOR_BGR2GRAY);
    return result;
  };
  for (const double mean : {0.0, 5.0, 128.0, 255.0}) {
    const cv::Mat covered = noise(208, 64, mean, 6.0);
    const PairReport left = checkPair(covered, grey(pair.right)),
                     right = checkPair(grey(pair.left), covered),
                     both = checkPair(covered, noise(208, 64, mean, 6.0, 2));
    EXPECT_EQ(left.reason, "the left image is blank: a covered lens?");
    EXPECT_EQ(right.reason, "the right image is blank: a covered lens?");
    EXPECT_EQ(both.reason, "both images are blank: covered lenses?");
    for (const PairReport& report : {left, right, both})
      EXPECT_EQ(report.fault, PairFault::blank);
  }
}

TEST(PairCheck, FindsOneImageGivenTwiceAndPairsThatDoNotBelongTogether)
{
  const Pair pair = street(1, 0), other = street(2, 20);
  EXPECT_EQ(faultOf(pair.left, pair.left.clone()), PairFault::identical);
  EXPECT_EQ(faultOf(pair.left, other.right), PairFault::unrelated);
  EXPECT_EQ(faultOf(pair.left, mirrored(pair.right)), PairFault::unrelated);
  EXPECT_EQ(faultOf(pair.left.rowRange(20, 188), pair.right.rowRange(0, 168)),
            PairFault::unrelated);
  EXPECT_EQ(faultOf(pair.left.rowRange(1, 188), pair.right.rowRange(0, 187)),
            PairFault::none); // badly rectified, but a pair
}

TEST(PairCheck, TakesImagesOfAnySize)
{
  for (const auto& [width, height] : {std::pair(1, 1),
                                      {1, 300},
                                      {15, 8},
                                      {20, 8},
                                      {33, 9},
                                      {959, 8},
                                      {960, 15},
                                      {5000, 7}}) {
    const cv::Mat texture = noise(width + 1, height, 128.0, 50.0);
    checkPair(texture.colRange(0, width), texture.colRange(1, width + 1));
  }
  thrownMessage<BadInputException>(
      [] { checkPair(noise(20, 20, 9, 9), noise(20, 19, 9, 9)); });
  thrownMessage<BadInputException>([] { checkPair(cv::Mat(), cv::Mat()); });
}

TEST(PairCheck, NeverErrsOnRealStreets)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "PCL_SEMANTIC_DATA is not set";
  const auto check = [](const cv::Mat& left, const cv::Mat& right) {
    EXPECT_EQ(faultOf(left, right), PairFault::none);
    EXPECT_EQ(faultOf(right, left), PairFault::swapped);
  };
  for (const char* const name : {"/kitti/00", "/kitti/03", "/kitti/05", "/kitti/07",
                                 "/kitti/09", "/kitti/15", "/kitti_gray/06"}) {
    const KittiSequence sequence(std::string(data) + name);
    for (std::size_t i = 0; i < sequence.size(); ++i) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(i));
      check(sequence.frame(i).left, sequence.frame(i).right);
    }
  }
  const std::string cones = std::string(data) + "/middlebury_cones/";
  check(readPng(cones + "im2.png", ImageKind::grey_or_colour),
        readPng(cones + "im6.png", ImageKind::grey_or_colour));
}

} // namespace pcl_semantic
