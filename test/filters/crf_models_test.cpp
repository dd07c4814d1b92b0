// SPDX-License-Identifier: BSD-3-Clause

// Every model and setting of SemanticCRF, against the plain mean field over the points
// that take part.

#include "support/plain_cloud_crf.h"
#include "support/plain_mean_field.h"
#include "support/random_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;
using Filter = SemanticCRF<pcl::PointXYZRGBL>;

constexpr int points = 150;

std::vector<pcl::PointIndices>
toPcl(const std::vector<std::vector<std::int32_t>>& lists)
{
  std::vector<pcl::PointIndices> cliques(lists.size());
  for (std::size_t c = 0; c < lists.size(); ++c)
    cliques[c].indices = lists[c];
  return cliques;
}

// A cloud of which every fifth point takes no part, and cliques that overlap, leave
// points out and reach beyond the indices; the first has no member that takes part.
struct Setting {
  CrfCloud input = makeCrfCloud(points, 11);
  pcl::Indices indices;
  std::vector<std::vector<std::int32_t>> cliques = makeCliques(25, 12, points, 17);
  SemanticCRFParameters parameters;

  Setting()
  {
    for (int i = 0; i < points; ++i)
      if (i % 5 != 0)
        indices.push_back(i);
    for (auto& clique : cliques) // all others have some that do
      if (std::all_of(clique.begin(), clique.end(), [](int i) { return i % 5 == 0; }))
        clique.push_back(clique.front() + 1);
    cliques.push_back(allIndices(points)); // no point is in no clique
    cliques.insert(cliques.begin(), {0, 5, 10});
    // Certain where their neighbours are uncertain: the cost of the excluded classes
    // counts.
    input.distributions.matrix().col(7) << 0.0f, 1.0f, 0.0f, 0.0f;
    input.distributions.matrix().col(8) << 0.5f, 0.0f, 0.5f, 0.0f;
    parameters.iterations = 3;
    parameters.clique_weight = 0.7;
  }

  // The cliques in numbers of the points that take part, without empty ones.
  std::vector<std::vector<std::int32_t>>
  cliquesThatTakePart() const
  {
    std::vector<std::vector<std::int32_t>> lists;
    for (const auto& clique : cliques) {
      std::vector<std::int32_t> members;
      for (const std::int32_t i : clique)
        if (i % 5 != 0)
          members.push_back(i / 5 * 4 + i % 5 - 1);
      if (!members.empty())
        lists.push_back(members);
    }
    return lists;
  }

  PlainCrf
  plain(CRFModelType model) const
  {
    PlainCrf crf = makePlainCrf(input, indices, parameters);
    if (model == CRFModelType::dense)
      return crf;
    PlainCliques potential;
    potential.type = model == CRFModelType::pn_potts ? CliquePotential::Type::pn_potts
                                                     : CliquePotential::Type::robust;
    potential.members = cliquesThatTakePart();
    potential.weights.setConstant(1, 1, float(parameters.clique_weight));
    potential.free_label = parameters.free_label;
    potential.truncation = float(parameters.clique_truncation);
    crf.cliques.push_back(potential);
    return crf;
  }

  void
  prepare(Filter& crf, CRFModelType model) const
  {
    crf.setModel(model);
    crf.setParameters(parameters);
    crf.setInputCloud(input.cloud);
    crf.setIndices(std::make_shared<pcl::Indices>(indices));
    crf.setLabelDistributions(input.distributions);
    crf.setCliques(toPcl(cliques));
  }
};

void
expectEqualsPlain(const Setting& setting, Filter& crf, const PlainCrf& plain,
                  const std::string& what)
{
  SCOPED_TRACE(what);
  Cloud output;
  crf.filter(output);
  PlainMeanField expected(plain);
  for (int i = 0; i < setting.parameters.iterations; ++i)
    expected.update();
  // Weights of 8 bits in the kernels, of which three updates make more.
  double worst = 0.0, change = 0.0;
  for (std::size_t k = 0; k < setting.indices.size(); ++k) {
    const Eigen::VectorXd refined =
        crf.getLabelDistributions().matrix().col(setting.indices[k]).cast<double>();
    worst = std::max(worst, (refined - expected.q.col(Eigen::Index(k))).norm());
    change = std::max(
        change,
        (refined -
         setting.input.distributions.matrix().col(setting.indices[k]).cast<double>())
            .norm());
  }
  EXPECT_LT(worst, 0.02);
  EXPECT_GT(change, 0.2);
  for (int i = 0; i < points; i += 5) {
    EXPECT_EQ(output[std::size_t(i)].label, 99u);
    EXPECT_EQ(crf.getLabelDistributions().matrix().col(i),
              setting.input.distributions.matrix().col(i));
  }
}

const CRFModelType every_model[] = {CRFModelType::dense, CRFModelType::pn_potts,
                                    CRFModelType::hierarchical};

TEST(CRFModels, EqualThePlainOnes)
{
  const Setting setting;
  for (const CRFModelType model : every_model) {
    Filter crf;
    setting.prepare(crf, model);
    expectEqualsPlain(setting, crf, setting.plain(model), std::to_string(int(model)));
    const bool uses_cliques = model != CRFModelType::dense;
    EXPECT_EQ(crf.getReport().skipped_cliques, uses_cliques ? 1u : 0u);
    EXPECT_EQ(crf.getReport().cliques,
              uses_cliques ? setting.cliquesThatTakePart().size() : 0u);
    EXPECT_EQ(crf.getReport().updates, 3);
  }
}

TEST(CRFModels, UnaryKeepsTheMeasurements)
{
  const Setting setting;
  const Eigen::MatrixXf& measured = setting.input.distributions.matrix();
  Filter crf;
  setting.prepare(crf, CRFModelType::unary);
  LabelDistributions scaled = setting.input.distributions;
  scaled.matrix().col(1) *= 8.0f;
  crf.setLabelDistributions(scaled);
  Cloud output;
  crf.filter(output);
  EXPECT_LT((crf.getLabelDistributions().matrix() - measured).cwiseAbs().maxCoeff(),
            1e-6f);
  EXPECT_EQ(crf.getReport().updates, 0);
  EXPECT_EQ(output[1].label, setting.input.distributions.mapLabel(1));
  EXPECT_EQ(output[5].label, 99u);
}

TEST(CRFModels, KernelsWithEveryNormalizationAndSelfInteraction)
{
  for (const Normalization normalization :
       {Normalization::symmetric, Normalization::one_sided, Normalization::none})
    for (const bool self_interaction : {false, true}) {
      Setting setting;
      setting.parameters.normalization = normalization;
      setting.parameters.self_interaction = self_interaction;
      if (normalization == Normalization::none) // else labels are certain at once
        setting.parameters.smoothness_weight = setting.parameters.appearance_weight =
            0.4;
      Filter crf;
      setting.prepare(crf, CRFModelType::dense);
      expectEqualsPlain(setting, crf, setting.plain(CRFModelType::dense),
                        std::to_string(int(normalization)));
    }
}

TEST(CRFModels, FullCompatibility)
{
  const Setting setting;
  const Eigen::MatrixXf half = makeRandomMatrix(4, 4, -0.2f, 0.6f, 13);
  for (const CRFModelType model : every_model) {
    PlainCrf plain = setting.plain(model);
    plain.compatibility = half;
    Filter crf;
    setting.prepare(crf, model);
    crf.setCompatibility(plain.compatibility);
    expectEqualsPlain(setting, crf, plain, std::to_string(int(model)));
  }
}

TEST(CRFModels, CostsStayWithTheirCliques)
{
  const Setting setting;
  const auto all = Eigen::Index(setting.cliques.size());
  // Those of the first clique belong to one that is skipped.
  const Eigen::MatrixXf costs = makeRandomMatrix(4, all, 0.0f, 2.0f, 15);
  ASSERT_EQ(setting.cliquesThatTakePart().size(), setting.cliques.size() - 1);
  PlainCrf plain = setting.plain(CRFModelType::hierarchical);
  plain.cliques[0].unary = costs.rightCols(all - 1);
  Filter crf;
  setting.prepare(crf, CRFModelType::hierarchical);
  crf.setCliqueCosts(costs);
  expectEqualsPlain(setting, crf, plain, "costs");
}

TEST(CRFModels, TheHierarchicalModelsOptions)
{
  const auto expect = [](auto&& change, const std::string& what) {
    Setting setting;
    change(setting.parameters);
    Filter crf;
    setting.prepare(crf, CRFModelType::hierarchical);
    expectEqualsPlain(setting, crf, setting.plain(CRFModelType::hierarchical), what);
  };
  expect([](SemanticCRFParameters& p) { p.free_label = false; }, "no free label");
  expect([](SemanticCRFParameters& p) { p.clique_truncation = 0.8; }, "truncation");
}

TEST(CRFModels, TheKernelBetweenCliques)
{
  Setting setting;
  setting.parameters.clique_appearance_weight = 0.9;
  setting.parameters.clique_appearance_deviation = 0.5;
  setting.parameters.clique_colour_deviation = 5.0;
  const auto cliques = setting.cliquesThatTakePart();
  Eigen::MatrixXf positions = Eigen::MatrixXf::Zero(3, Eigen::Index(cliques.size()));
  Eigen::MatrixXf colours = positions;
  for (std::size_t c = 0; c < cliques.size(); ++c)
    for (const std::int32_t k : cliques[c]) {
      const auto& point =
          (*setting.input.cloud)[std::size_t(setting.indices[std::size_t(k)])];
      const float share = 1.0f / float(cliques[c].size());
      const auto column = static_cast<Eigen::Index>(c);
      const std::uint8_t rgb[] = {point.r, point.g, point.b};
      for (int a = 0; a < 3; ++a) {
        positions(a, column) += share * point.data[a];
        colours(a, column) += share * float(rgb[a]);
      }
    }
  PlainCrf plain = setting.plain(CRFModelType::hierarchical);
  plain.cliques[0].kernels = {
      plainKernelMatrix(positions, colours / 5.0f, 0.9, 0.5, setting.parameters)};
  Filter crf;
  setting.prepare(crf, CRFModelType::hierarchical);
  expectEqualsPlain(setting, crf, plain, "kernel between cliques");
  // It matters.
  const Eigen::MatrixXf with = crf.getLabelDistributions().matrix();
  setting.parameters.clique_appearance_weight = 0.0;
  crf.setParameters(setting.parameters);
  Cloud output;
  crf.filter(output);
  EXPECT_GT((crf.getLabelDistributions().matrix() - with).cwiseAbs().maxCoeff(), 0.02f);
}

TEST(CRFModels, AKernelOfTheCallersOwn)
{
  // The same kernel once as that of positions, once as the caller's.
  Setting setting;
  setting.parameters.kernel_method = KernelMethod::lattice;
  setting.parameters.smoothness_deviation = 0.2;
  setting.parameters.appearance_weight = 0.0;
  Filter usual;
  setting.prepare(usual, CRFModelType::dense);
  Cloud output;
  usual.filter(output);
  Eigen::MatrixXf features(3, points);
  for (int i = 0; i < points; ++i)
    for (int a = 0; a < 3; ++a)
      features(a, i) = ((*setting.input.cloud)[std::size_t(i)].data[a] -
                        (*setting.input.cloud)[1].data[a]) /
                       0.2f;
  setting.parameters.smoothness_weight = 0.0;
  Filter own;
  setting.prepare(own, CRFModelType::dense);
  own.addKernel(features, 3.0f);
  own.filter(output);
  EXPECT_LT(
      (own.getLabelDistributions().matrix() - usual.getLabelDistributions().matrix())
          .cwiseAbs()
          .maxCoeff(),
      1e-5f);
}

// Two groups of points out of reach of each other; the second has no measurement.
CrfCloud
makeIslands(int classes)
{
  CrfCloud input = makeCrfCloud(100, 19);
  input.distributions = LabelDistributions(classes, 100);
  for (std::size_t i = 0; i < 100; ++i) {
    (*input.cloud)[i].x += i < 50 ? 0.0f : 100.0f;
    if (i < 25)
      input.distributions.setLabel(Eigen::Index(i), 1, 0.9f);
  }
  return input;
}

TEST(CRFModels, WhatHearsOfNoLabelStaysUnlabelled)
{
  for (const int classes : {1, 2, 5}) {
    const CrfCloud input = makeIslands(classes);
    Filter crf;
    SemanticCRFParameters parameters;
    parameters.iterations = 8;
    crf.setParameters(parameters);
    crf.setInputCloud(input.cloud);
    crf.setLabelDistributions(input.distributions);
    Cloud output;
    crf.filter(output);
    EXPECT_EQ(crf.getReport().unlabelled, 75u);
    int labelled = 0;
    for (std::size_t i = 25; i < 50; ++i)
      labelled += output[i].label == 1 ? 1 : 0;
    EXPECT_EQ(labelled, classes == 1 ? 0 : 25)
        << classes; // one class gives no messages
    for (std::size_t i = 50; i < 100; ++i)
      EXPECT_EQ(output[i].label, kUnlabelled) << classes;
    if (classes != 2)
      continue;
    Eigen::MatrixXf costs(2, 2); // a matrix that prefers a class
    costs << 0.0f, 0.5f, 1.0f, 0.0f;
    crf.setCompatibility(costs);
    crf.filter(output);
    EXPECT_EQ(output[60].label, 1u);
  }
}

} // namespace
