// SPDX-License-Identifier: BSD-3-Clause
#include "superpixels/kernels/slic_assignment.h"
#include "superpixels/slic_cliques.h"
#include "support/same_image.h"
#include "support/supported_tiers.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <limits>
#include <map>
#include <random>

using namespace pcl_semantic;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Regions of four colours with slanted and round borders.
cv::Mat
knownRegions(int width, int height)
{
  cv::Mat regions(height, width, CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      regions.at<std::uint8_t>(v, u) = u + v / 2 < width / 2 ? 0 : 1;
  cv::circle(regions, {width / 4, height / 2}, height / 5, cv::Scalar(2), cv::FILLED);
  cv::circle(regions, {3 * width / 4, height / 3}, height / 4, cv::Scalar(3),
             cv::FILLED);
  return regions;
}

cv::Mat
colourRegions(const cv::Mat& regions)
{
  const cv::Vec3b colours[] = {
      {200, 90, 60}, {60, 180, 80}, {50, 60, 200}, {220, 220, 40}};
  std::mt19937 random(3);
  std::uniform_int_distribution<int> noise(-12, 12);
  cv::Mat image(regions.size(), CV_8UC3);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      for (int channel = 0; channel < 3; ++channel)
        image.at<cv::Vec3b>(v, u)[channel] = cv::saturate_cast<std::uint8_t>(
            colours[regions.at<std::uint8_t>(v, u)][channel] + noise(random));
  return image;
}

cv::Mat
someImage(int width = 320, int height = 120)
{
  return colourRegions(knownRegions(width, height));
}

SlicParameters
parametersOf(int superpixels, int downscale)
{
  SlicParameters parameters;
  parameters.superpixels = superpixels;
  parameters.downscale = downscale;
  return parameters;
}

int
largest(const cv::Mat& segments)
{
  double most = 0.0;
  cv::minMaxLoc(segments, nullptr, &most);
  return int(most);
}

// Pixels outside of the region that most pixels of their superpixel belong to.
int
strayPixels(const cv::Mat& segments, const cv::Mat& regions)
{
  std::map<int, std::map<int, int>> counts;
  for (int v = 0; v < segments.rows; ++v)
    for (int u = 0; u < segments.cols; ++u)
      ++counts[segments.at<int>(v, u)][regions.at<std::uint8_t>(v, u)];
  int stray = 0;
  for (const auto& [segment, by_region] : counts) {
    int sum = 0, most = 0;
    for (const auto& [region, count] : by_region) {
      sum += count;
      most = std::max(most, count);
    }
    stray += sum - most;
  }
  return stray;
}

CliqueGenerator::Cloud
organizedCloud(const cv::Mat& image)
{
  CliqueGenerator::Cloud cloud(unsigned(image.cols), unsigned(image.rows));
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const cv::Vec3b& colour = image.at<cv::Vec3b>(v, u);
      cloud(std::size_t(u), std::size_t(v)) = {float(u),  float(v),  5.0f,
                                               colour[2], colour[1], colour[0]};
    }
  return cloud;
}

} // namespace

TEST(Slic, KeepsToTheBordersOfColours)
{
  const cv::Mat regions = knownRegions(400, 160), image = colourRegions(regions);
  for (const int downscale : {1, 2}) {
    const cv::Mat segments = slicSuperpixels(image, parametersOf(100, downscale));
    ASSERT_EQ(segments.size(), image.size());
    ASSERT_EQ(segments.type(), CV_32SC1);
    // The borders are about 700 pixels long.
    EXPECT_LT(strayPixels(segments, regions), downscale == 1 ? 70 : 600) << downscale;
  }
}

TEST(Slic, GivesAboutAsManyAsAskedFor)
{
  for (const int superpixels : {12, 150, 1000}) {
    const int count =
        largest(slicSuperpixels(someImage(), parametersOf(superpixels, 1))) + 1;
    EXPECT_GE(count, superpixels * 0.75);
    EXPECT_LE(count, superpixels * 1.25);
  }
}

TEST(Slic, NumbersAreWithoutGapInTheOrderOfFirstPixels)
{
  const cv::Mat segments = slicSuperpixels(someImage(), SlicParameters());
  int next = 0;
  for (int v = 0; v < segments.rows; ++v)
    for (int u = 0; u < segments.cols; ++u) {
      ASSERT_LE(segments.at<int>(v, u), next);
      next += segments.at<int>(v, u) == next ? 1 : 0;
    }
  EXPECT_GT(next, 100);
}

TEST(Slic, SuperpixelsAreConnectedAndNotTiny)
{
  const cv::Mat image = someImage();
  const cv::Mat segments = slicSuperpixels(image, parametersOf(150, 1));
  const int mean_size = int(image.total()) / 150;
  for (int i = 0; i <= largest(segments); ++i) {
    cv::Mat parts;
    const cv::Mat mask = segments == i;
    EXPECT_EQ(cv::connectedComponents(mask, parts, 4), 2) << i; // it and the others
    EXPECT_GE(cv::countNonZero(mask), mean_size / 5) << i;
  }
}

TEST(Slic, TheNumberOfThreadsChangesNothing)
{
  const cv::Mat image = someImage(500, 200);
  setNumberOfThreads(1);
  const cv::Mat expected = slicSuperpixels(image, SlicParameters());
  for (const int threads : {2, 7}) {
    setNumberOfThreads(threads);
    EXPECT_TRUE(isSameImage(slicSuperpixels(image, SlicParameters()), expected))
        << threads;
  }
  setNumberOfThreads(0);
}

TEST(Slic, AssignmentGivesTheSameBitsInEveryTier)
{
  constexpr int width = 203;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0.0f, 255.0f);
  std::vector<float> lab(3 * width);
  for (float& channel : lab)
    channel = value(random);
  const auto assign = [&](SimdTier tier) {
    std::vector<float> distances(width, std::numeric_limits<float>::infinity());
    std::vector<int> labels(width, -1);
    const SlicRow row{{lab.data(), lab.data() + width, lab.data() + 2 * width},
                      distances.data(),
                      labels.data(),
                      width,
                      3.0f};
    slicAssignment(tier)(row, {90.0f, 120.0f, 130.0f, 60.3f, 5.7f}, 0, 2, 150, 0.7f);
    slicAssignment(tier)(row, {170.0f, 110.0f, 140.0f, 140.9f, 1.2f}, 1, 61, 203, 0.7f);
    return std::make_pair(distances, labels);
  };
  const auto plain = assign(SimdTier::plain);
  EXPECT_EQ(plain.second[1], -1); // before the first centre's pixels
  for (int x = 2; x < width; ++x) {
    const auto distance = [&](float l, float a, float b, float cx, float cy) {
      return std::pow(lab[x] - l, 2) + std::pow(lab[width + x] - a, 2) +
             std::pow(lab[2 * width + x] - b, 2) +
             0.7 * (std::pow(x - cx, 2) + std::pow(3.0 - cy, 2));
    };
    const double first = x < 150 ? distance(90.0f, 120.0f, 130.0f, 60.3f, 5.7f) : 1e9;
    const double second =
        x >= 61 ? distance(170.0f, 110.0f, 140.0f, 140.9f, 1.2f) : 1e9;
    EXPECT_EQ(plain.second[x], first <= second ? 0 : 1) << x;
    EXPECT_NEAR(plain.first[x], std::min(first, second), 1e-2) << x;
  }
  for (const SimdTier tier : supportedTiers())
    EXPECT_EQ(assign(tier), plain) << nameOf(tier);
}

TEST(Slic, TakesGreyAndVerySmallImages)
{
  cv::Mat grey;
  cv::extractChannel(someImage(), grey, 2);
  EXPECT_GT(largest(slicSuperpixels(grey, SlicParameters())), 100);
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(1, 40), cv::Size(40, 1), cv::Size(5, 3)})
    for (const int downscale : {1, 2, 16})
      for (const int superpixels : {1, 150}) {
        const cv::Mat segments =
            slicSuperpixels(cv::Mat(size, CV_8UC3, cv::Scalar(1, 2, 3)),
                            parametersOf(superpixels, downscale));
        EXPECT_EQ(segments.size(), size);
        EXPECT_LT(largest(segments), int(segments.total()));
      }
}

TEST(Slic, RefusesOtherImages)
{
  for (const cv::Mat& image : {cv::Mat(), cv::Mat(20, 20, CV_16UC1, cv::Scalar(1)),
                               cv::Mat(20, 20, CV_8UC4, cv::Scalar(1, 1, 1, 1))})
    thrownMessage<BadInputException>([&] { slicSuperpixels(image, SlicParameters()); });
}

TEST(Slic, RefusesBadParametersByName)
{
  const auto message = [](auto SlicParameters::*parameter, auto value) {
    SlicParameters parameters;
    parameters.*parameter = value;
    return thrownMessage<InvalidParameterException>(
        [&] { SlicCliques cliques(parameters); });
  };
  for (const int value : {0, -1, 1 << 20}) {
    EXPECT_TRUE(holds(message(&SlicParameters::superpixels, value), "superpixels"));
    EXPECT_TRUE(holds(message(&SlicParameters::iterations, value), "iterations"));
    EXPECT_TRUE(holds(message(&SlicParameters::downscale, value), "downscale"));
  }
  for (const double value : {0.0, -1.0, double(kNaN), 1e30})
    EXPECT_TRUE(holds(message(&SlicParameters::compactness, value), "compactness"));
}

TEST(SlicCliques, EveryFinitePointIsInTheCliqueOfItsSuperpixel)
{
  const cv::Mat image = someImage(160, 60);
  CliqueGenerator::Cloud cloud = organizedCloud(image);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 160; ++u)
      if (u < 80 || (u + v) % 7 == 0) // whole superpixels, and holes in others
        cloud(std::size_t(u), std::size_t(v)).z = kNaN;
  SlicCliques generator;
  EXPECT_TRUE(generator.usesColour());
  const auto cliques = generator.generate(cloud);

  const cv::Mat segments = slicSuperpixels(image, SlicParameters());
  std::map<int, std::vector<int>> expected; // superpixel -> finite points
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (std::isfinite(cloud[i].z))
      expected[segments.at<int>(int(i) / 160, int(i) % 160)].push_back(int(i));
  ASSERT_EQ(cliques.size(), expected.size());
  EXPECT_LT(int(expected.size()), largest(segments) + 1); // some had no point
  for (const pcl::PointIndices& clique : cliques) {       // one plane is not split
    ASSERT_FALSE(clique.indices.empty());
    const int first = clique.indices[0];
    EXPECT_EQ(std::vector<int>(clique.indices.begin(), clique.indices.end()),
              expected[segments.at<int>(first / 160, first % 160)]);
  }
}

TEST(SlicCliques, RefusesAnUnorganizedCloudAndTakesAnEmptyOne)
{
  CliqueGenerator::Cloud cloud = organizedCloud(someImage(40, 20));
  cloud.width = 800;
  cloud.height = 1;
  expectBadInput("organized", [&] { SlicCliques().generate(cloud); });
  cloud.height = 2;
  expectBadParameter("a height of 2, but 800 points",
                     [&] { SlicCliques().generate(cloud); });
  EXPECT_TRUE(SlicCliques().generate(CliqueGenerator::Cloud()).empty());
}

TEST(CliquesOfSegments, OtherNumbersAreRefused)
{
  for (const int number : {-1, 12, 1 << 30}) {
    cv::Mat1i segments(3, 4, 0);
    segments(1, 2) = number;
    expectBadParameter("pixel (2, 1) has the segment " + std::to_string(number),
                       [&] { cliquesOfSegments(segments); });
  }
  EXPECT_THROW(cliquesOfSegments(cv::Mat1b(3, 4)), InvalidParameterException);
}

TEST(CliquesOfSegments, ListEveryPixelOnce)
{
  const cv::Mat segments = (cv::Mat_<int>(2, 3) << 0, 0, 1, 2, 0, 1);
  const auto cliques = cliquesOfSegments(segments);
  ASSERT_EQ(cliques.size(), 3u);
  EXPECT_EQ(cliques[0].indices, (pcl::Indices{0, 1, 4}));
  EXPECT_EQ(cliques[1].indices, (pcl::Indices{2, 5}));
  EXPECT_EQ(cliques[2].indices, (pcl::Indices{3}));
  EXPECT_TRUE(cliquesOfSegments(cv::Mat()).empty());
}
