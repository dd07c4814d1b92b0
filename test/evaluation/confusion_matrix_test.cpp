// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace pcl_semantic {

namespace {

const std::vector<Label> evaluated{1, 3, 4};

LabelSet
fourClasses()
{
  return LabelSet({{"building", {128, 0, 0}},
                   {"sky", {128, 128, 128}, true},
                   {"road", {128, 64, 128}},
                   {"sign", {0, 64, 128}}});
}

cv::Mat1b
randomLabels(unsigned seed, int largest)
{
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> label(0, largest);
  cv::Mat1b image(30, 40);
  for (std::uint8_t& pixel : image)
    pixel = static_cast<std::uint8_t>(label(random));
  return image;
}

struct Pixel {
  int truth, prediction;
};

/** \brief Figures of one class counted pixel by pixel, as design.md defines them. */
ClassScores
bruteForce(const std::vector<Pixel>& pixels, int label)
{
  double tp = 0, fn = 0, fp = 0, uncovered = 0;
  ClassScores scores;
  for (const Pixel& pixel : pixels) {
    if (pixel.truth != 1 && pixel.truth != 3 && pixel.truth != 4)
      continue;
    if (pixel.truth == label) {
      ++scores.pixels;
      if (pixel.prediction == 0)
        ++uncovered;
      else if (pixel.prediction == label)
        ++tp;
      else
        ++fn;
    }
    else if (pixel.prediction == label)
      ++fp;
  }
  scores.covered = static_cast<std::uint64_t>(tp + fn);
  scores.iou_exclusive = tp / (tp + fn + fp);
  scores.iou_inclusive = tp / (tp + fn + uncovered + fp);
  scores.recall = tp / (tp + fn);
  scores.precision = tp / (tp + fp);
  return scores;
}

} // namespace

TEST(ConfusionMatrix, ScoresEqualBruteForce)
{
  ConfusionMatrix pooled(4);
  std::vector<Pixel> pixels;
  for (unsigned image = 0; image < 3; ++image) {
    const cv::Mat1b truth = randomLabels(10 + image, 4);
    cv::Mat1b prediction = randomLabels(20 + image, 4);
    truth.copyTo(prediction, randomLabels(30 + image, 2) > 0);
    const cv::Mat1b covered = randomLabels(40 + image, 3);
    ConfusionMatrix one(4);
    one.add(truth, prediction, image == 2 ? cv::Mat(covered) : cv::Mat());
    pooled += one;
    for (int row = 0; row < truth.rows; ++row)
      for (int column = 0; column < truth.cols; ++column)
        if (image != 2 || covered(row, column))
          pixels.push_back({truth(row, column), prediction(row, column)});
  }
  const Scores scores = computeScores(pooled, evaluated);
  ASSERT_EQ(scores.classes.size(), 3u);
  double mean = 0.0, inclusive = 0.0, right = 0.0, weighted = 0.0;
  double covered = 0.0, total = 0.0;
  for (const ClassScores& result : scores.classes) {
    const ClassScores expected = bruteForce(pixels, result.label);
    EXPECT_EQ(result.pixels, expected.pixels);
    EXPECT_EQ(result.covered, expected.covered);
    EXPECT_DOUBLE_EQ(result.iou_exclusive, expected.iou_exclusive);
    EXPECT_DOUBLE_EQ(result.iou_inclusive, expected.iou_inclusive);
    EXPECT_DOUBLE_EQ(result.recall, expected.recall);
    EXPECT_DOUBLE_EQ(result.precision, expected.precision);
    EXPECT_LT(result.iou_inclusive, result.iou_exclusive);
    mean += expected.iou_exclusive / 3.0;
    inclusive += expected.iou_inclusive / 3.0;
    right += expected.recall * double(expected.covered);
    weighted += expected.iou_exclusive * double(expected.covered);
    covered += double(expected.covered);
    total += double(expected.pixels);
  }
  EXPECT_NEAR(scores.mean.iou_exclusive, mean, 1e-12);
  EXPECT_NEAR(scores.mean.iou_inclusive, inclusive, 1e-12);
  EXPECT_NEAR(scores.global_accuracy, right / covered, 1e-12);
  EXPECT_NEAR(scores.frequency_weighted_iou, weighted / covered, 1e-12);
  EXPECT_NEAR(scores.coverage, covered / total, 1e-12);
}

TEST(ConfusionMatrix, ByHand)
{
  // One pixel each: right, predicted as an ignored class, uncovered, truth ignored,
  // no truth.
  const cv::Mat1b truth = (cv::Mat1b(1, 5) << 1, 1, 1, 2, 0);
  const cv::Mat1b prediction = (cv::Mat1b(1, 5) << 1, 2, 0, 1, 1);
  ConfusionMatrix confusion(4);
  confusion.add(truth, prediction);
  const Scores scores = computeScores(confusion, evaluated);
  EXPECT_DOUBLE_EQ(scores.classes[0].iou_exclusive, 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(scores.classes[0].iou_inclusive, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(scores.classes[0].precision, 1.0);
  EXPECT_DOUBLE_EQ(scores.coverage, 2.0 / 3.0);
  // Classes that are not in the truth do not lower the mean.
  EXPECT_TRUE(std::isnan(scores.classes[1].iou_exclusive));
  EXPECT_DOUBLE_EQ(scores.mean.iou_exclusive, 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(scores.mean.iou_inclusive, 1.0 / 3.0);
}

TEST(ConfusionMatrix, CoveredTruthOnlyDecidesTheExclusiveMean)
{
  const cv::Mat1b truth = (cv::Mat1b(1, 4) << 1, 1, 3, 3);
  const cv::Mat1b prediction = (cv::Mat1b(1, 4) << 1, 1, 0, 0);
  ConfusionMatrix confusion(4);
  confusion.add(truth, prediction);
  const Scores scores = computeScores(confusion, evaluated);
  EXPECT_DOUBLE_EQ(scores.mean.iou_exclusive, 1.0);
  EXPECT_DOUBLE_EQ(scores.mean.iou_inclusive, 0.5);
}

TEST(ConfusionMatrix, CountsMayBeAddedAsTheyAre)
{
  const cv::Mat truth = (cv::Mat_<std::uint8_t>(1, 5) << 1, 1, 2, 0, 2);
  const cv::Mat prediction = (cv::Mat_<std::uint8_t>(1, 5) << 1, 1, 0, 2, 1);
  ConfusionMatrix by_image(2), by_count(2);
  by_image.add(truth, prediction);
  by_count.add(1, 1, 2);
  for (const auto& [true_label, label] : {std::pair(2, 0), {0, 2}, {2, 1}})
    by_count.add(Label(true_label), Label(label), 1);
  for (int i = 0; i <= 2; ++i)
    for (int j = 0; j <= 2; ++j)
      EXPECT_EQ(by_count(Label(i), Label(j)), by_image(Label(i), Label(j)));
  EXPECT_THROW(by_count.add(3, 0, 1), InvalidParameterException);
  EXPECT_THROW(by_count.add(0, 3, 1), InvalidParameterException);
}

TEST(ConfusionMatrix, RefusesImagesThatDoNotFit)
{
  ConfusionMatrix confusion(4);
  const cv::Mat1b image(3, 3, Label(1)), beyond(3, 3, Label(5)), other(3, 4, Label(1));
  const auto refusalOf = [&](const auto&... images) {
    return thrownMessage<BadInputException>([&] { confusion.add(images...); });
  };
  EXPECT_TRUE(holds(refusalOf(beyond, image), "holds the label 5"));
  EXPECT_TRUE(holds(refusalOf(image, beyond), "prediction holds"));
  EXPECT_TRUE(holds(refusalOf(image, other), "4 x 3"));
  EXPECT_TRUE(holds(refusalOf(image, image, other), "covered"));
  EXPECT_EQ(confusion(1, 1), 0u);
  EXPECT_THROW(confusion += ConfusionMatrix(5), InvalidParameterException);
  EXPECT_THROW(ConfusionMatrix(0), InvalidParameterException);
  EXPECT_THROW(ConfusionMatrix(256), InvalidParameterException);
  EXPECT_THROW(computeScores(confusion, {5}), InvalidParameterException);
  EXPECT_THROW(computeScores(confusion, {0}), InvalidParameterException);
}

TEST(EvaluationReport, Texts)
{
  const cv::Mat1b truth = (cv::Mat1b(1, 4) << 1, 1, 1, 3);
  const cv::Mat1b prediction = (cv::Mat1b(1, 4) << 1, 2, 0, 3);
  ConfusionMatrix confusion(4);
  confusion.add(truth, prediction);
  const Scores scores = computeScores(confusion, evaluated);
  EXPECT_EQ(scoresMarkdownHeader(scores, fourClasses()),
            "| | building | road | sign | mean | global accuracy | mean inclusive | "
            "coverage |\n|---|---:|---:|---:|---:|---:|---:|---:|\n");
  EXPECT_EQ(scoresMarkdownRow(scores, "x"),
            "| x | 50.0 | 100.0 | - | 75.0 | 66.7 | 66.7 | 75.0 |\n");
  EXPECT_EQ(scoresMarkdownRow(scores, "x|y").substr(0, 9), "| x\\|y | ");
  const std::string table = scoresTable(scores, fourClasses());
  EXPECT_NE(table.find("building           50.0           33.3           50.0"
                       "          100.0           3\n"),
            std::string::npos)
      << table;
  const auto json = nlohmann::json::parse(scoresJson(scores, fourClasses()));
  EXPECT_EQ(json["classes"][0]["name"], "building");
  EXPECT_DOUBLE_EQ(json["classes"][0]["iou_exclusive"], 0.5);
  EXPECT_TRUE(json["classes"][2]["iou_exclusive"].is_null());
  EXPECT_DOUBLE_EQ(json["mean"]["iou_exclusive"], 0.75);
  EXPECT_DOUBLE_EQ(json["coverage"], 0.75);
  EXPECT_EQ(confusionCsv(confusion, fourClasses()),
            "truth \\ prediction,uncovered,building,sky,road,sign\n"
            "unlabelled,0,0,0,0,0\nbuilding,1,1,1,0,0\nsky,0,0,0,0,0\n"
            "road,0,0,0,1,0\nsign,0,0,0,0,0\n");
  EXPECT_EQ(confusionCsv(ConfusionMatrix(1), LabelSet({{"a, \"b\""}})),
            "truth \\ prediction,uncovered,\"a, \"\"b\"\"\"\nunlabelled,0,0\n"
            "\"a, \"\"b\"\"\",0,0\n");
}

TEST(EvaluationReport, NothingToEvaluate)
{
  const Scores scores = computeScores(ConfusionMatrix(4), evaluated);
  EXPECT_EQ(scoresMarkdownRow(scores, "x"), "| x | - | - | - | - | - | - | - |\n");
  EXPECT_TRUE(
      nlohmann::json::parse(scoresJson(scores, fourClasses()))["global_accuracy"]
          .is_null());
}

} // namespace pcl_semantic
