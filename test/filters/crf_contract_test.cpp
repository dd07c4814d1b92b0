// SPDX-License-Identifier: BSD-3-Clause

// Guarantees besides the mathematics: indices, types, bad input.

#include "superpixels/slic_cliques.h"
#include "support/plain_cloud_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <pcl/common/io.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

/** \brief Members are called otherwise than their fields, and colour is PCL's float. */
struct OddPoint {
  double weight;
  float east, north, up;
  float packed;
  std::uint16_t kind;
};

POINT_CLOUD_REGISTER_POINT_STRUCT(OddPoint,
                                  (float, east, x)(float, north, y)(float, up, z)(
                                      float, packed, rgb)(std::uint16_t, kind, label))

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;
using Filter = CrfFilter;

SemanticCRFParameters
fiveUpdates()
{
  SemanticCRFParameters parameters;
  parameters.iterations = 5;
  return parameters;
}

// A cloud whose points are the voxels of some indices, relative to an origin [m].
std::vector<VoxelIndex>
placeVoxels(CrfCloud& cloud, const VoxelIndex& shift, double origin)
{
  std::vector<VoxelIndex> indices;
  for (pcl::PointXYZRGBL& point : *cloud.cloud) {
    const Eigen::Vector3f cell = (point.getVector3fMap() / 0.1f).array().round();
    indices.push_back(cell.cast<int>() + shift);
    for (int a = 0; a < 3; ++a)
      point.data[a] = float((double(indices.back()(a)) + 0.5) * 0.1 - origin);
  }
  return indices;
}

TEST(CRFPlaces, AVoxelCloudMayLieAnywhere)
{
  const VoxelIndex nowhere(0, 0, 0), far(1000000, -1000000, 3000000); // 100 km, 300 km
  for (const CRFModelType model : {CRFModelType::dense, CRFModelType::hierarchical}) {
    std::vector<Eigen::MatrixXf> results;
    for (const auto& [shift, origin] :
         {std::pair(nowhere, 0.0), {nowhere, 100000.0}, {far, 0.0}, {far, 7000.0}}) {
      CrfCloud input = makeCrfCloud(400, 21);
      const std::vector<VoxelIndex> indices = placeVoxels(input, shift, origin);
      Filter crf;
      crf.setModel(model);
      crf.setCliqueGenerator(std::make_shared<CubeCliques>(1.0));
      crf.setParameters(fiveUpdates());
      crf.setVoxels(indices, 0.1);
      results.push_back(refine(crf, input));
    }
    for (const Eigen::MatrixXf& result : results)
      EXPECT_EQ(result, results[0]) << int(model); // to the last bit
    EXPECT_GT(
        largestDifference(results[0], makeCrfCloud(400, 21).distributions.matrix()),
        0.2f);
  }
}

TEST(CRFPlaces, APlainCloudIsReCentred)
{
  // Multiples of 1/8 are exact as floats up to 1,000 km; divided by a deviation of a
  // kernel they are not, unless they are taken from nearby.
  for (const KernelMethod method : {KernelMethod::truncated, KernelMethod::lattice}) {
    std::vector<Eigen::MatrixXf> results;
    for (const float shift : {0.0f, 131072.0f, 1048576.0f}) {
      CrfCloud input = makeCrfCloud(300, 22);
      for (pcl::PointXYZRGBL& point : *input.cloud)
        for (int a = 0; a < 3; ++a)
          point.data[a] = std::round(point.data[a] * 10.0f) * 0.125f - shift;
      SemanticCRFParameters parameters;
      parameters.kernel_method = method;
      Filter crf = filterWith(parameters);
      results.push_back(refine(crf, input));
    }
    EXPECT_EQ(results[1], results[0]);
    EXPECT_EQ(results[2], results[0]);
  }
}

TEST(CRFPlaces, APointFarOffHurtsNoOther)
{
  for (const KernelMethod method : {KernelMethod::automatic, KernelMethod::lattice})
    for (const float distance : {50e3f, 5000e3f}) { // 50 km, 5,000 km
      CrfCloud input = makeCrfCloud(300, 22);
      SemanticCRFParameters parameters;
      parameters.kernel_method = method;
      std::vector<Eigen::MatrixXf> results;
      for (const std::size_t far : {0, 299}) {
        const pcl::PointXYZRGBL kept = (*input.cloud)[far];
        (*input.cloud)[far].x = distance;
        Filter crf = filterWith(parameters);
        results.push_back(refine(crf, input));
        (*input.cloud)[far] = kept;
        // An isolated point keeps its measurement; the results of the others do not
        // change.
        EXPECT_LT(
            largestDifference(results.back().col(Eigen::Index(far)),
                              input.distributions.matrix().col(Eigen::Index(far))),
            1e-5f);
        pcl::IndicesPtr others(new pcl::Indices(allIndices(300)));
        others->erase(others->begin() + std::ptrdiff_t(far));
        parameters.kernel_method =
            distance > 100e3f ? KernelMethod::lattice : method; // as automatic chooses
        Filter near = filterWith(parameters);
        near.setIndices(others);
        const Eigen::MatrixXf expected = refine(near, input);
        for (const pcl::index_t i : *others)
          EXPECT_LT(largestDifference(results.back().col(i), expected.col(i)), 1e-4f);
        parameters.kernel_method = method;
      }
    }
}

TEST(CRFPlaces, TheOrderOfPointsDoesNotMatter)
{
  const Eigen::Index count = 1500;
  for (const bool are_voxels : {true, false})
    for (const KernelMethod method : {KernelMethod::truncated, KernelMethod::lattice}) {
      CrfCloud input = makeCrfCloud(count, 31), shuffled = makeCrfCloud(count, 31);
      if (!are_voxels)
        for (Eigen::Index i = 0; i < count; ++i)
          (*input.cloud)[std::size_t(i)].getVector3fMap() =
              makeRandomMatrix(3, 1, 0.0f, 2.0f, unsigned(i) + 100);
      const std::vector<VoxelIndex> voxels = placeVoxels(shuffled, {7, -3, 2}, 0.0);
      std::vector<int> order(static_cast<std::size_t>(count));
      std::iota(order.begin(), order.end(), 0);
      std::shuffle(order.begin(), order.end(), std::minstd_rand(32));
      std::vector<VoxelIndex> shuffled_voxels;
      for (std::size_t k = 0; k < order.size(); ++k) {
        (*shuffled.cloud)[k] = (*input.cloud)[std::size_t(order[k])];
        shuffled_voxels.push_back(voxels[std::size_t(order[k])]);
      }
      shuffled.distributions.matrix() =
          input.distributions.matrix()(Eigen::all, order).eval();
      SemanticCRFParameters parameters = fiveUpdates();
      parameters.kernel_method = method;
      parameters.sensor = PointSensor::lidar; // narrower lattices round more
      Filter crf = filterWith(parameters), other = filterWith(parameters);
      if (are_voxels) {
        crf.setVoxels(voxels, 0.1);
        other.setVoxels(shuffled_voxels, 0.1);
      }
      const Eigen::MatrixXf expected = refine(crf, input)(Eigen::all, order);
      EXPECT_LT(largestDifference(refine(other, shuffled), expected), 1e-5f);
    }
}

TEST(CRFPlaces, PointsOutOfReachAreSkippedAndCounted)
{
  const CrfCloud whole = makeCrfCloud(120, 23);
  CrfCloud input = makeCrfCloud(120, 23);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<int, float> bad[] = {
      {0, nan}, {7, 1e30f}, {30, -1e30f}, {31, std::numeric_limits<float>::infinity()}};
  pcl::IndicesPtr others(new pcl::Indices(allIndices(120)));
  for (const auto& [i, place] : bad) {
    (*input.cloud)[std::size_t(i)].y = place;
    input.cloud->is_dense = false;
    others->erase(std::find(others->begin(), others->end(), i));
  }
  Filter crf, alone;
  for (Filter* filter : {&crf, &alone}) {
    filter->setModel(CRFModelType::hierarchical);
    filter->setCliqueGenerator(std::make_shared<CubeCliques>(0.5));
  }
  Cloud output;
  const Eigen::MatrixXf refined = refine(crf, input, &output);
  EXPECT_EQ(crf.getSkippedPoints(), 4u);
  EXPECT_GT(crf.getReport().updates, 0);
  alone.setIndices(others);
  const Eigen::MatrixXf expected = refine(alone, whole);
  for (const pcl::index_t i : *others)
    EXPECT_EQ(refined.col(i), expected.col(i)) << i;
  EXPECT_FALSE(output.is_dense);
  for (const auto& [i, place] : bad) {
    EXPECT_EQ(output[std::size_t(i)].label, 0u);
    EXPECT_EQ(refined.col(i).sum(), 0.0f);
  }
}

TEST(CRFPlaces, ACloudWithoutPlacesHasAReportOfItsOwn)
{
  CrfCloud input = makeCrfCloud(50, 23);
  Filter crf;
  refine(crf, input);
  EXPECT_EQ(crf.getReport().updates, 3);
  for (pcl::PointXYZRGBL& point : *input.cloud)
    point.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refine(crf, input).isZero(0.0f));
  EXPECT_EQ(crf.getSkippedPoints(), 50u);
  EXPECT_EQ(crf.getReport().updates, 0);
}

TEST(CRFPlaces, OrganizationHeaderAndPoseAreKept)
{
  CrfCloud input = makeCrfCloud(120, 24);
  input.cloud->width = 12;
  input.cloud->height = 10;
  input.cloud->header.frame_id = "map";
  input.cloud->sensor_origin_ = Eigen::Vector4f(1, 2, 3, 0);
  Filter crf;
  Cloud output;
  refine(crf, input, &output);
  EXPECT_EQ(output.width, 12u);
  EXPECT_EQ(output.height, 10u);
  EXPECT_EQ(output.header.frame_id, "map");
  EXPECT_EQ(output.sensor_origin_, input.cloud->sensor_origin_);
  crf.filter(*input.cloud); // in place
  EXPECT_EQ(input.cloud->height, 10u);
  for (std::size_t i = 0; i < output.size(); ++i)
    EXPECT_EQ((*input.cloud)[i].label, output[i].label);
}

TEST(CRFPlaces, SameResultForAnyNumberOfThreadsAndAnyOrderOfIndices)
{
  const CrfCloud input = makeCrfCloud(700, 25);
  std::vector<Eigen::MatrixXf> results;
  for (const int threads : {1, 2, 7}) {
    Filter crf;
    crf.setNumberOfThreads(threads);
    crf.setModel(CRFModelType::hierarchical);
    crf.setCliqueGenerator(std::make_shared<CubeCliques>(0.5));
    crf.setParameters(fiveUpdates());
    pcl::IndicesPtr indices(new pcl::Indices(allIndices(700)));
    if (threads > 1) {
      std::reverse(indices->begin(), indices->end());
      indices->push_back(3); // twice
    }
    crf.setIndices(indices);
    results.push_back(refine(crf, input));
  }
  EXPECT_EQ(results[1], results[0]);
  EXPECT_EQ(results[2], results[0]);
}

TEST(CRFTypes, FieldsAreFoundByTheirNames)
{
  const CrfCloud input = makeCrfCloud(200, 26);
  pcl::PointCloud<OddPoint>::Ptr odd(new pcl::PointCloud<OddPoint>);
  for (const pcl::PointXYZRGBL& point : *input.cloud) {
    OddPoint other{};
    other.east = point.x;
    other.north = point.y;
    other.up = point.z;
    other.packed = point.rgb;
    odd->push_back(other);
  }
  Filter usual;
  const Eigen::MatrixXf expected = refine(usual, input);
  SemanticCRF<OddPoint> crf;
  crf.setInputCloud(odd);
  crf.setLabelDistributions(input.distributions);
  pcl::PointCloud<OddPoint> output;
  crf.filter(output);
  EXPECT_EQ(crf.getLabelDistributions().matrix(), expected);
  for (std::size_t i = 0; i < output.size(); ++i)
    EXPECT_EQ(output[i].kind, usual.getLabelDistributions().mapLabel(Eigen::Index(i)));
}

TEST(CRFTypes, WithoutColourTheSecondKernelIsOneOfPositions)
{
  const CrfCloud input = makeCrfCloud(200, 27);
  SemanticCRFParameters parameters;
  parameters.smoothness_weight += parameters.appearance_weight;
  parameters.appearance_weight = 0.0;
  parameters.sensor = PointSensor::lidar;
  Filter positions_only = filterWith(parameters);
  const Eigen::MatrixXf expected = refine(positions_only, input);
  Filter without_colour;
  without_colour.setUseColour(false);
  EXPECT_EQ(refine(without_colour, input), expected);
  parameters = {};
  parameters.sensor = PointSensor::lidar;
  parameters.appearance_deviation = 0.3; // another than that of the first kernel
  without_colour.setParameters(parameters);
  CrfCloud black = input; // kernels of equal colours
  black.cloud = pcl::make_shared<Cloud>(*input.cloud);
  for (pcl::PointXYZRGBL& point : *black.cloud)
    point.rgba = 0;
  Filter of_black = filterWith(parameters);
  EXPECT_LT(largestDifference(refine(without_colour, input), refine(of_black, black)),
            1e-5f);
  pcl::PointCloud<pcl::PointXYZLNormal>::Ptr cloud(
      new pcl::PointCloud<pcl::PointXYZLNormal>);
  for (const pcl::PointXYZRGBL& point : *input.cloud) {
    pcl::PointXYZLNormal plain;
    plain.getVector3fMap() = point.getVector3fMap();
    cloud->push_back(plain);
  }
  SemanticCRF<pcl::PointXYZLNormal> crf;
  crf.setInputCloud(cloud);
  crf.setLabelDistributions(input.distributions);
  pcl::PointCloud<pcl::PointXYZLNormal> output;
  crf.filter(output);
  EXPECT_EQ(crf.getLabelDistributions().matrix(), expected);
  crf.setModel(CRFModelType::hierarchical);
  crf.setCliqueGenerator(std::make_shared<SlicCliques>());
  expectBadParameter("colour", [&] { crf.filter(output); });
}

TEST(CRFInput, HardLabelsAreDistributionsOfAConfidence)
{
  CrfCloud input = makeCrfCloud(200, 28);
  for (int i = 0; i < 200; ++i) {
    (*input.cloud)[std::size_t(i)].label = std::uint32_t(i % 5); // some unlabelled
    input.distributions.setLabel(i, Label(i % 5), 0.7f);
  }
  Filter soft, hard;
  const Eigen::MatrixXf expected = refine(soft, input);
  EXPECT_EQ(soft.getReport().unlabelled, 40u);
  hard.setInputCloud(input.cloud);
  hard.setLabelConfidence(0.7, 4);
  Cloud output;
  hard.filter(output);
  EXPECT_EQ(hard.getLabelDistributions().matrix(), expected);
  (*input.cloud)[9].label = 5;
  expectBadInput("point 9 has the label 5, expected 0 to 4",
                 [&] { hard.filter(output); });
  pcl::IndicesPtr others(new pcl::Indices(allIndices(200)));
  others->erase(others->begin() + 9);
  hard.setIndices(others);
  hard.filter(output);
  EXPECT_EQ(output[9].label, 5u);
  EXPECT_THROW(hard.setLabelConfidence(1.1, 4), InvalidParameterException);
  EXPECT_THROW(hard.setLabelConfidence(0.5, 0), InvalidParameterException);
  EXPECT_THROW(hard.setLabelConfidence(0.5, 256), InvalidParameterException);
}

// Streets and scans lose by it (doc/parameters.md).
TEST(CRFInput, TheLogitAdjustmentOfMapsIsForImagesOfAnRgbdCamera)
{
  SemanticCRFParameters parameters = SemanticCRFParameters::forMaps();
  EXPECT_EQ(parameters.resolved(0.1, true).logit_adjustment, 0.0);
  parameters.sensor = PointSensor::rgbd;
  EXPECT_EQ(parameters.resolved(0.1, true).logit_adjustment, 1.0);
  parameters.sensor = PointSensor::stereo;
  EXPECT_EQ(parameters.resolved(0.1, true).logit_adjustment, 0.0);
  parameters.logit_adjustment = 0.3;
  EXPECT_EQ(parameters.resolved(0.1, true).logit_adjustment, 0.3);
}

// Menon et al. 2021: measurements over the frequencies of their classes. By hand, and
// without the adjustment.
TEST(CRFInput, ALogitAdjustmentDividesByTheFrequenciesOfTheClasses)
{
  CrfCloud input = makeCrfCloud(300, 25);
  auto& measured = input.distributions.matrix();
  measured.row(0) *= 20.0f; // a frequent class; the scale of a column is free
  measured.col(7).setZero();
  measured.col(8).setConstant(0.25f);
  CrfCloud adjusted = input;
  Eigen::VectorXd frequencies = Eigen::VectorXd::Zero(measured.rows());
  for (Eigen::Index i = 0; i < measured.cols(); ++i)
    if (i != 7 && i != 8)
      frequencies += measured.col(i).cast<double>() / double(measured.col(i).sum());
  frequencies /= frequencies.sum();
  ASSERT_GT(frequencies.maxCoeff(), 0.3);
  ASSERT_LT(frequencies.minCoeff(), 0.1);
  for (Eigen::Index i = 0; i < measured.cols(); ++i)
    if (i != 7 && i != 8)
      for (Eigen::Index l = 0; l < measured.rows(); ++l)
        adjusted.distributions.matrix()(l, i) /=
            float(std::pow(std::max(frequencies[l], 0.1), 0.7));
  SemanticCRFParameters parameters;
  parameters.smoothness_weight = parameters.appearance_weight = 0.3;
  parameters.logit_adjustment = 0.7;
  Filter crf = filterWith(parameters);
  const Eigen::MatrixXf result = refine(crf, input);
  parameters.logit_adjustment = 0.0;
  Filter plain = filterWith(parameters);
  EXPECT_LT(largestDifference(result, refine(plain, adjusted)), 1e-5f);
  EXPECT_GT(largestDifference(result, refine(plain, input)), 0.1f);
  // Those of a larger map, for a part of it.
  parameters.logit_adjustment = 0.7;
  Filter part = filterWith(parameters);
  part.setClassFrequencies(frequencies);
  EXPECT_LT(largestDifference(result, refine(part, input)), 1e-5f);
  part.setClassFrequencies(Eigen::VectorXd::Constant(4, 0.25));
  EXPECT_LT(largestDifference(refine(part, input), refine(plain, input)), 1e-5f);
  part.setClassFrequencies(Eigen::VectorXd::Constant(3, 0.3));
  expectBadParameter("frequencies of 3 classes, expected 4",
                     [&] { refine(part, input); });
  expectBadParameter("a class frequency is negative or not finite", [&] {
    part.setClassFrequencies(Eigen::VectorXd::Constant(4, -1));
  });
}

TEST(CRFInput, AGeneratorsCliquesAreThoseItMakesOfTheCloud)
{
  const CrfCloud input = makeCrfCloud(300, 29);
  CliqueGenerator::Cloud cloud;
  pcl::copyPointCloud(*input.cloud, cloud);
  Filter given, made;
  given.setModel(CRFModelType::hierarchical);
  made.setModel(CRFModelType::hierarchical);
  given.setCliques(CubeCliques(0.4).generate(cloud));
  made.setCliqueGenerator(std::make_shared<CubeCliques>(0.4));
  const Eigen::MatrixXf expected = refine(given, input);
  EXPECT_EQ(refine(made, input), expected);
  // The last setting is used.
  made.setCliques({});
  EXPECT_NE(refine(made, input), expected);
  made.setCliqueGenerator(std::make_shared<CubeCliques>(0.4));
  EXPECT_EQ(refine(made, input), expected);
  made.setCliqueGenerator(nullptr);
  EXPECT_THROW(refine(made, input), InvalidParameterException);
}

// Makes no groups, and stores its input.
struct Watcher : CliqueGenerator {
  std::vector<pcl::PointIndices>
  generate(const CliqueGenerator::Cloud& cloud) override
  {
    *seen = cloud;
    return {};
  }

  bool
  usesColour() const override
  {
    return true;
  }

  std::shared_ptr<CliqueGenerator::Cloud> seen =
      std::make_shared<CliqueGenerator::Cloud>();
};

TEST(CRFInput, AGeneratorIsGivenPlacesAndColours)
{
  CrfCloud input = makeCrfCloud(60, 33);
  input.cloud->width = 10;
  input.cloud->height = 6;
  (*input.cloud)[7].z = 1e30f;
  Filter crf;
  crf.setModel(CRFModelType::hierarchical);
  const auto watcher = std::make_shared<Watcher>();
  crf.setCliqueGenerator(watcher);
  refine(crf, input);
  ASSERT_EQ(watcher->seen->size(), 60u);
  EXPECT_EQ(watcher->seen->height, 6u);
  for (std::size_t i = 0; i < 60; ++i) {
    const pcl::PointXYZRGB& seen = (*watcher->seen)[i];
    EXPECT_EQ(seen.r, (*input.cloud)[i].r);
    EXPECT_EQ(seen.g, (*input.cloud)[i].g);
    EXPECT_EQ(seen.b, (*input.cloud)[i].b);
    if (i == 7)
      EXPECT_TRUE(std::isnan(seen.x) && std::isnan(seen.y) && std::isnan(seen.z));
    else
      EXPECT_EQ(seen.getVector3fMap(), (*input.cloud)[i].getVector3fMap());
  }
}

TEST(CRFInput, WhatDoesNotFitIsRefused)
{
  using Prepare = std::function<void(Filter&)>;
  const auto with = [](const std::vector<pcl::Indices>& lists) -> Prepare {
    std::vector<pcl::PointIndices> cliques(lists.size());
    for (std::size_t c = 0; c < lists.size(); ++c)
      cliques[c].indices = lists[c];
    return [=](Filter& crf) {
      crf.setModel(CRFModelType::hierarchical);
      crf.setCliques(cliques);
    };
  };
  const auto indices = [](const pcl::Indices& list) {
    return std::make_shared<pcl::Indices>(list);
  };
  const auto kernel = [](const Eigen::MatrixXf& features, float weight) -> Prepare {
    return [=](Filter& crf) { crf.addKernel(features, weight); };
  };
  const auto voxels = [](double size) -> Prepare {
    return [=](Filter& crf) { crf.setVoxels({VoxelIndex(0, 0, 0)}, size); };
  };
  const auto measured = [](const LabelDistributions& distributions) -> Prepare {
    return [=](Filter& crf) { crf.setLabelDistributions(distributions); };
  };
  const std::vector<std::pair<const char*, Prepare>> cases = {
      {"clique 1 is empty", with({{0, 1}, {}})},
      {"clique 1 has the index 40", with({{0, 1}, {0, 40}})},
      {"clique 1 has the index -1", with({{0, 1}, {-1}})},
      {"clique 1 has the index 1 twice", with({{0, 1}, {1, 2, 1}})},
      // The number of the caller, even where an earlier clique takes no part.
      {"clique 1 has the index 1 twice",
       [&](Filter& crf) {
         with({{3}, {1, 2, 1}})(crf);
         crf.setIndices(indices({1, 2}));
       }},
      {"needs cliques", [](Filter& crf) { crf.setModel(CRFModelType::pn_potts); }},
      {"39 points for a cloud of 40", measured(LabelDistributions(4, 39))},
      {"needs measurements", measured(LabelDistributions())},
      {"voxel indices of 1 points", voxels(0.1)},
      {"voxel size is 0", voxels(0.0)},
      {"39 points, expected 40", kernel(Eigen::MatrixXf::Ones(2, 39), 1.0f)},
      {"kernel weight is -1", kernel(Eigen::MatrixXf::Ones(2, 40), -1.0f)},
      {"not all finite", kernel(Eigen::MatrixXf::Constant(2, 40, std::nanf("")), 1.0f)},
      {"compatibility is of 3 classes, expected 4",
       [](Filter& crf) { crf.setCompatibility(Eigen::MatrixXf::Ones(3, 3)); }},
      {"index 40 is beyond the cloud of 40",
       [&](Filter& crf) { crf.setIndices(indices({40})); }}};
  for (const auto& [says, prepare] : cases) {
    const CrfCloud input = makeCrfCloud(40, 30);
    Filter crf;
    crf.setInputCloud(input.cloud);
    crf.setLabelDistributions(input.distributions);
    expectBadParameter(says, [&, &change = prepare] {
      change(crf);
      Cloud output;
      crf.filter(output);
    });
  }
}

TEST(CRFInput, ProbabilitiesHaveAnyScaleButThoseThatCannotBeAreNamed)
{
  CrfCloud scaled = makeCrfCloud(100, 32);
  Filter filter;
  const Eigen::MatrixXf expected = refine(filter, scaled);
  scaled.distributions.matrix() *= 8.0f;
  EXPECT_LT(largestDifference(refine(filter, scaled), expected), 1e-5f);
  for (const float bad :
       {std::nanf(""), -0.1f, std::numeric_limits<float>::infinity()}) {
    CrfCloud input = makeCrfCloud(40, 31);
    input.distributions.matrix()(2, 17) = bad;
    Filter crf;
    expectBadInput("point 17 has a negative or non-finite probability",
                   [&] { refine(crf, input); });
  }
}

TEST(CRFInput, ParametersOutOfRangeAreRefused)
{
  using P = SemanticCRFParameters;
  const double nan = std::nan("");
  struct Case {
    std::vector<double P::*> members;
    std::vector<double> values;
  };
  for (const auto& [members, values] : std::vector<Case>{
           {{&P::smoothness_weight, &P::appearance_weight, &P::clique_weight,
             &P::clique_appearance_weight},
            {-1.0, nan, 1e300}},
           {{&P::smoothness_deviation, &P::appearance_deviation, &P::colour_deviation},
            {-1.0, nan, 1e300, 1e-12, 9.9e-10}},
           {{&P::radius, &P::clique_truncation, &P::clique_appearance_deviation,
             &P::clique_colour_deviation},
            {0.0, -1.0, nan, 1e300}},
           {{&P::clique_truncation}, {1.1}}})
    for (double P::*const member : members)
      for (const double value : values) {
        P parameters;
        parameters.*member = value;
        EXPECT_THROW(filterWith(parameters), InvalidParameterException) << value;
      }
  P parameters;
  parameters.iterations = -1;
  EXPECT_THROW(filterWith(parameters), InvalidParameterException);
}

} // namespace
