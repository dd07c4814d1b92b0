// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_cloud_crf.h"
#include "support/plain_mean_field.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/images/image_crf.h>

#include <opencv2/core.hpp>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;

constexpr int width = 18, height = 11, pixels = width * height;

cv::Mat
makeImage(int channels)
{
  std::mt19937 random(1);
  cv::Mat image(height, width, CV_8UC(channels));
  for (int i = 0; i < pixels * channels; ++i)
    image.data[i] = std::uint8_t(100 + random() % 12);
  return image;
}

LabelDistributions
makeDistributions()
{
  return LabelDistributions(makeRandomMatrix(3, pixels, 0.05f, 1.0f, 2));
}

// Segments 0 (none), 4 and 9.
cv::Mat
makeSegments(int type)
{
  cv::Mat1i segments(height, width, 0);
  segments(cv::Rect(0, 0, 7, 11)).setTo(9);
  segments(cv::Rect(9, 3, 6, 5)).setTo(4);
  cv::Mat converted;
  segments.convertTo(converted, type);
  return converted;
}

// Short deviations and truncated sums, so that the plain kernels are the same.
SemanticCRFParameters
makeParameters()
{
  SemanticCRFParameters parameters = SemanticCRFParameters::forImages();
  parameters.kernel_method = KernelMethod::truncated;
  parameters.smoothness_deviation = 1.5;
  parameters.appearance_deviation = 2.5;
  parameters.iterations = 3;
  return parameters;
}

PlainCrf
makePlain(const cv::Mat& image, const SemanticCRFParameters& parameters)
{
  Eigen::MatrixXf positions(2, pixels), colours(image.channels(), pixels);
  for (int i = 0; i < pixels; ++i) {
    positions.col(i) << float(i % width), float(i / width);
    for (int c = 0; c < image.channels(); ++c)
      colours(c, i) = float(image.data[i * image.channels() + c]);
  }
  PlainCrf crf;
  crf.unary = plainUnary(makeDistributions().matrix());
  crf.kernels = {
      plainKernelMatrix(positions, {}, parameters.smoothness_weight, 1.5, parameters),
      plainKernelMatrix(positions, colours / float(parameters.colour_deviation),
                        parameters.appearance_weight, 2.5, parameters)};
  return crf;
}

void
expectEqualsPlain(const PlainCrf& plain, const LabelDistributions& refined)
{
  PlainMeanField expected(plain);
  for (int i = 0; i < 3; ++i)
    expected.update();
  // Weights of 8 bits in the kernels, of which three updates make more.
  EXPECT_LT((refined.matrix().cast<double>() - expected.q).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_GT((refined.matrix() - makeDistributions().matrix()).cwiseAbs().maxCoeff(),
            0.2f);
}

// doc/parameters.md has the reasons.
TEST(ImageCRF, DefaultsAreThoseForImages)
{
  const SemanticCRFParameters parameters = SemanticCRFParameters::forImages();
  EXPECT_EQ(parameters.smoothness_deviation, 3.0);
  EXPECT_EQ(parameters.appearance_deviation, 40.0);
  EXPECT_EQ(parameters.colour_deviation, 4.0);
  EXPECT_EQ(parameters.iterations, 5);
}

TEST(ImageCRF, EqualsThePlainModelOverPixels)
{
  for (const int channels : {1, 3}) {
    const cv::Mat image = makeImage(channels);
    ImageCRF crf;
    crf.setParameters(makeParameters());
    expectEqualsPlain(makePlain(image, makeParameters()),
                      crf.refine(image, makeDistributions()));
  }
}

TEST(ImageCRF, SegmentsAreCliques)
{
  const cv::Mat image = makeImage(3);
  PlainCliques cliques;
  cliques.members.resize(2); // in the order of the numbers: 4, 9
  const cv::Mat1i segments = makeSegments(CV_32S);
  for (int i = 0; i < pixels; ++i)
    if (segments(i / width, i % width) > 0)
      cliques.members[segments(i / width, i % width) == 4 ? 0 : 1].push_back(i);
  for (const CRFModelType model : {CRFModelType::pn_potts, CRFModelType::hierarchical})
    for (const int type : {CV_8U, CV_16U, CV_32S}) {
      cliques.type = model == CRFModelType::pn_potts ? CliquePotential::Type::pn_potts
                                                     : CliquePotential::Type::robust;
      PlainCrf plain = makePlain(image, makeParameters());
      plain.cliques = {cliques};
      ImageCRF crf;
      crf.setModel(model);
      crf.setParameters(makeParameters());
      crf.setSegments(makeSegments(type));
      expectEqualsPlain(plain, crf.refine(image, makeDistributions()));
      EXPECT_EQ(crf.getReport().cliques, 2u);
    }
}

TEST(ImageCRF, ARegionOfALargerImageIsTheSame)
{
  const cv::Mat image = makeImage(3);
  cv::Mat larger(height + 4, width + 5, CV_8UC3, cv::Scalar::all(9));
  image.copyTo(larger(cv::Rect(2, 3, width, height)));
  ImageCRF crf;
  EXPECT_EQ(
      crf.refine(larger(cv::Rect(2, 3, width, height)), makeDistributions()).matrix(),
      crf.refine(image, makeDistributions()).matrix());
}

TEST(ImageCRF, SpecksVanishAndEdgesStay)
{
  // Two halves of different grey, one pixel in 20 labelled wrongly.
  constexpr int w = 120, h = 80;
  cv::Mat1b image(h, w, std::uint8_t(60));
  image(cv::Rect(w / 2, 0, w / 2, h)).setTo(120);
  LabelDistributions measured(3, w * h);
  std::mt19937 random(3);
  for (int i = 0; i < w * h; ++i) {
    const Label truth = i % w < w / 2 ? 1 : 2;
    measured.setLabel(i, random() % 20 == 0 ? 3 : truth, 0.6f);
  }
  for (const KernelMethod method : {KernelMethod::automatic, KernelMethod::lattice}) {
    ImageCRF crf;
    SemanticCRFParameters parameters = SemanticCRFParameters::forImages();
    parameters.kernel_method = method;
    crf.setParameters(parameters);
    const LabelDistributions refined = crf.refine(image, measured);
    int wrong = 0;
    for (int i = 0; i < w * h; ++i)
      wrong += refined.mapLabel(i) != (i % w < w / 2 ? 1 : 2);
    EXPECT_EQ(wrong, 0);
  }
}

TEST(ImageCRF, RefusesWhatDoesNotFit)
{
  ImageCRF crf;
  const auto complaint = [&](auto&& body) {
    return thrownMessage<InvalidParameterException>(body);
  };
  EXPECT_TRUE(holds(complaint([&] {
                      crf.refine(cv::Mat(height, width, CV_16UC1), makeDistributions());
                    }),
                    "another type"));
  EXPECT_TRUE(holds(complaint([&] { crf.refine(cv::Mat(), makeDistributions()); }),
                    "198 pixels for an image of 0 x 0"));
  EXPECT_TRUE(holds(
      complaint([&] { crf.refine(makeImage(3), LabelDistributions(3, pixels - 1)); }),
      "197 pixels for an image of 18 x 11"));
  EXPECT_TRUE(holds(complaint([&] { crf.setSegments(cv::Mat1f(height, width, 1.0f)); }),
                    "channel of integers"));
  EXPECT_TRUE(holds(complaint([&] { crf.setSegments(cv::Mat1i(height, width, -1)); }),
                    "pixel (0, 0) has the segment -1"));
  EXPECT_TRUE(holds(complaint([&] { crf.setSegments(cv::Mat()); }), "is empty"));
  crf.setModel(CRFModelType::hierarchical);
  EXPECT_TRUE(holds(complaint([&] { crf.refine(makeImage(3), makeDistributions()); }),
                    "needs cliques"));
  crf.setSegments(cv::Mat1i(width, height, 1)); // as many pixels
  EXPECT_TRUE(holds(complaint([&] { crf.refine(makeImage(3), makeDistributions()); }),
                    "segments of 11 x 18 pixels for an image of 18 x 11"));
  pcl::PointIndices beyond;
  beyond.indices = {198};
  crf.setCliques({beyond}); // of no image
  EXPECT_TRUE(holds(complaint([&] { crf.refine(makeImage(3), makeDistributions()); }),
                    "clique 0 has the index 198, expected 0 to 197"));
}

} // namespace
