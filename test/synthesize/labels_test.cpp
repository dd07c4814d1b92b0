// SPDX-License-Identifier: BSD-3-Clause
#include "support/same_image.h"
#include "support/temporary_folder.h"
#include "synthesize/labels.h"
#include "synthesize/writer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <array>

using namespace pcl_semantic;

namespace {

SyntheticView
renderView(std::uint32_t seed, int frame)
{
  return SyntheticRenderer(SyntheticScene(seed), 310, 94).render(frame);
}

/** \brief 255 where a pixel's most probable label is not the true one. */
cv::Mat
mistakes(const SyntheticView& view, double noise)
{
  const LabelDistributions distributions = syntheticDistributions(view, 1, noise);
  cv::Mat labels(view.labels.size(), CV_8UC1);
  for (Eigen::Index i = 0; i < distributions.size(); ++i)
    labels.ptr<Label>()[i] = distributions.mapLabel(i);
  return labels != view.labels;
}

} // namespace

TEST(SyntheticLabels, AreTheClassesOfTheLabelSetFile)
{
  const LabelSet set =
      readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
  ASSERT_EQ(set.size(), synthetic_classes);
  const char* const names[] = {"building", "sky",   "road",       "vegetation",
                               "sidewalk", "car",   "pedestrian", "cyclist",
                               "sign",     "fence", "pole"};
  for (int label = synthetic_building; label <= synthetic_pole; ++label)
    EXPECT_EQ(set.find(names[label - 1]), label);
}

TEST(SyntheticLabels, EveryColumnIsADistribution)
{
  const SyntheticView view = renderView(1, 3);
  for (const double noise : {0.0, 0.5, 1.0}) {
    const LabelDistributions distributions = syntheticDistributions(view, 1, noise);
    ASSERT_EQ(distributions.classes(), synthetic_classes);
    ASSERT_EQ(distributions.size(), 310 * 94);
    EXPECT_GT(distributions.matrix().minCoeff(), 0.0f);
    const Eigen::RowVectorXf sums = distributions.matrix().colwise().sum();
    EXPECT_NEAR(sums.minCoeff(), 1.0f, 1e-5f);
    EXPECT_NEAR(sums.maxCoeff(), 1.0f, 1e-5f);
  }
}

TEST(SyntheticLabels, MoreNoiseMeansMoreMistakes)
{
  const SyntheticView view = renderView(2, 10);
  int before = -1;
  for (const double noise : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const int wrong = cv::countNonZero(mistakes(view, noise));
    EXPECT_GT(wrong, before) << "noise " << noise;
    before = wrong;
  }
  EXPECT_EQ(cv::countNonZero(mistakes(view, 0.0)), 0);
  for (const double noise : {-0.01, 1.01, std::nan("")})
    EXPECT_THROW(syntheticDistributions(view, 1, noise), InvalidParameterException);
}

TEST(SyntheticLabels, DefaultIsAsHardAsRealStreets)
{
  const SyntheticScene scene(1);
  const SyntheticRenderer renderer(scene, 310, 94);
  std::array<double, synthetic_classes + 1> both{}, either{};
  int wrong = 0, confident = 0;
  for (int frame = 0; frame < scene.frames(); frame += 5) {
    const SyntheticView view = renderer.render(frame);
    const LabelDistributions distributions = syntheticDistributions(view, 1);
    for (Eigen::Index i = 0; i < distributions.size(); ++i) {
      const Label truth = view.labels.ptr<Label>()[i];
      const Label label = distributions.mapLabel(i);
      ++either[truth];
      if (label == truth) {
        ++both[truth];
        continue;
      }
      ++either[label];
      ++wrong;
      confident += distributions.column(i)[label - 1] > 0.7f;
    }
  }
  double mean = 0.0;
  for (const int label : {1, 3, 4, 5, 6, 9, 10, 11})
    mean += both[label] / either[label] / 8.0;
  EXPECT_GT(mean, 0.55);
  EXPECT_LT(mean, 0.75);
  EXPECT_GT(confident, 0.25 * wrong) << "networks are confidently wrong";
  EXPECT_LT(confident, 0.85 * wrong);
}

TEST(SyntheticLabels, MistakesAreBlobs)
{
  const cv::Mat wrong = mistakes(renderView(1, 20), kSyntheticLabelNoise);
  int count = 0, lonely = 0;
  for (int v = 1; v + 1 < wrong.rows; ++v)
    for (int u = 1; u + 1 < wrong.cols; ++u)
      if (wrong.at<std::uint8_t>(v, u)) {
        ++count;
        lonely += cv::countNonZero(wrong(cv::Rect(u - 1, v - 1, 3, 3))) <= 2;
      }
  EXPECT_GT(count, 1000);
  EXPECT_LT(lonely, 0.05 * count);
}

// The same view as another frame: a part of the mistakes stays, most of them move.
TEST(SyntheticLabels, MistakesChangeFromFrameToFrame)
{
  SyntheticView view = renderView(1, 20);
  const cv::Mat first = mistakes(view, kSyntheticLabelNoise);
  view.frame = 21;
  const cv::Mat second = mistakes(view, kSyntheticLabelNoise);
  const double both = cv::countNonZero(first & second);
  const double share = both / cv::countNonZero(first | second);
  const double by_chance = double(cv::countNonZero(first)) / first.total();
  EXPECT_LT(share, 0.6);
  EXPECT_GT(both / cv::countNonZero(first), 1.3 * by_chance);
}

TEST(SyntheticLabels, BytesDependOnTheSeedAndNotOnTheThreads)
{
  setNumberOfThreads(1);
  const SyntheticView one = renderView(5, 7);
  const LabelDistributions one_labels = syntheticDistributions(one, 5);
  setNumberOfThreads(3);
  const SyntheticView other = renderView(5, 7);
  const LabelDistributions other_labels = syntheticDistributions(other, 5);
  setNumberOfThreads(0);
  for (const auto image : {&SyntheticView::left, &SyntheticView::right,
                           &SyntheticView::disparity, &SyntheticView::labels})
    EXPECT_TRUE(isSameImage(one.*image, other.*image));
  EXPECT_EQ(one_labels.matrix(), other_labels.matrix());

  const SyntheticView street = renderView(6, 7);
  EXPECT_FALSE(isSameImage(one.labels, street.labels));
  EXPECT_FALSE(isSameImage(one.disparity, street.disparity));
  EXPECT_NE(syntheticDistributions(one, 6).matrix(), one_labels.matrix());
}

TEST(SyntheticWriter, WhatItWritesReadsBack)
{
  const TemporaryFolder temporary;
  const std::string folder = temporary.path();
  const SyntheticScene scene(8, 3);
  const SyntheticRenderer renderer(scene, 96, 40);
  const SyntheticWriter writer(folder);
  writer.writeSequence(scene, renderer.camera());
  const SyntheticView view = renderer.render(2);
  const LabelDistributions distributions = syntheticDistributions(view, 8);
  writer.writeFrame(view, distributions);

  const std::string png = "/000002.png";
  const auto read = [&](const std::string& name, ImageKind kind) {
    return readPng(folder + "/" + name + png, kind);
  };
  EXPECT_TRUE(isSameImage(read("image_2", ImageKind::grey_or_colour), view.left));
  EXPECT_TRUE(isSameImage(read("image_3", ImageKind::grey_or_colour), view.right));
  EXPECT_TRUE(isSameImage(read("gt", ImageKind::labels), view.labels));
  const cv::Mat disparity = read("disparity", ImageKind::disparity);
  for (std::size_t i = 0; i < disparity.total(); ++i)
    ASSERT_NEAR(disparity.ptr<std::uint16_t>()[i] / 256.0,
                view.disparity.ptr<float>()[i], 0.002);
  EXPECT_TRUE(
      readDistributions(folder + "/labels/000002.bin", 96, 40, synthetic_classes, 1.0f)
          .matrix()
          .isApprox(distributions.matrix(), 1e-6f));

  const Trajectory poses = readKittiTrajectory(folder + "/poses.txt");
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_TRUE(poses[2].isApprox(scene.kittiPose(2), 1e-9));
  EXPECT_EQ(readLines(folder + "/times.txt").size(), 3u);
}

// A point in camera 0 must project to where the renderer saw it.
TEST(SyntheticWriter, CalibrationProjectsToTheImages)
{
  const TemporaryFolder temporary;
  const std::string folder = temporary.path();
  const SyntheticScene scene(8, 1);
  const SyntheticRenderer renderer(scene, 128, 64);
  SyntheticWriter(folder).writeSequence(scene, renderer.camera());
  const std::vector<TextLine> lines = readLines(folder + "/calib.txt");
  ASSERT_EQ(lines.size(), 5u);
  std::array<Eigen::Matrix<double, 3, 4>, 5> matrices;
  const std::array<std::string, 5> names{"P0: ", "P1: ", "P2: ", "P3: ", "Tr: "};
  for (int k = 0; k < 5; ++k) {
    ASSERT_EQ(lines[k].text.substr(0, 4), names[k]);
    const std::vector<double> numbers = parseNumbers(lines[k].text.substr(4), "calib");
    ASSERT_EQ(numbers.size(), 12u);
    for (int i = 0; i < 12; ++i)
      matrices[k](i / 4, i % 4) = numbers[i];
  }
  const SyntheticView view = renderer.render(0);
  for (int v = 33; v < 64; v += 5)
    for (int u = 2; u < 128; u += 9) {
      const double disparity = view.disparity.at<float>(v, u);
      if (disparity == 0.0)
        continue;
      const Eigen::Vector3d world =
          view.T_world_camera *
          view.camera.unproject(u, v, view.camera.depth(disparity));
      const Eigen::Vector4d p = (scene.pose(0).inverse() * world).homogeneous();
      const Eigen::Vector3d left = matrices[2] * p;
      const Eigen::Vector3d right = matrices[3] * p;
      EXPECT_NEAR(left.x() / left.z(), u, 1e-4);
      EXPECT_NEAR(left.y() / left.z(), v, 1e-4);
      EXPECT_NEAR(right.x() / right.z(), u - disparity, 1e-4);
    }
}
