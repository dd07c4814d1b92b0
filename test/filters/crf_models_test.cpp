// SPDX-License-Identifier: BSD-3-Clause

// Every model and setting of SemanticCRF, against the plain mean field over the points
// that take part: one setting at a time, and random small problems.

#include "support/plain_cloud_crf.h"
#include "support/plain_mean_field.h"
#include "support/random_crf.h"
#include "support/thrown_message.h"

#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZRGBL>;
using Filter = CrfFilter;

constexpr int points = 150;

std::vector<pcl::PointIndices>
toPcl(const std::vector<std::vector<std::int32_t>>& lists)
{
  std::vector<pcl::PointIndices> cliques(lists.size());
  for (std::size_t c = 0; c < lists.size(); ++c)
    cliques[c].indices = lists[c];
  return cliques;
}

void
addCliques(PlainCrf& crf, CRFModelType model,
           const std::vector<std::vector<std::int32_t>>& members,
           const SemanticCRFParameters& parameters)
{
  if (model == CRFModelType::dense)
    return;
  PlainCliques cliques;
  cliques.type = model == CRFModelType::pn_potts ? CliquePotential::Type::pn_potts
                                                 : CliquePotential::Type::robust;
  cliques.members = members;
  cliques.weights.setConstant(1, 1, float(parameters.clique_weight));
  cliques.free_label = parameters.free_label;
  cliques.truncation = float(parameters.clique_truncation);
  crf.cliques.push_back(cliques);
  crf.start_from_cliques = parameters.clique_start;
}

Eigen::MatrixXd
plainMarginals(const PlainCrf& crf, int iterations)
{
  PlainMeanField field(crf);
  for (int i = 0; i < iterations; ++i)
    field.update();
  return field.q;
}

// The largest distances of a point's distribution from the expected and from the
// measured one.
std::pair<double, double>
errorAndChange(const Filter& crf, const CrfCloud& input, const pcl::Indices& indices,
               const Eigen::MatrixXd& expected)
{
  double worst = 0.0, change = 0.0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const Eigen::VectorXd refined =
        crf.getLabelDistributions().matrix().col(indices[k]).cast<double>();
    const Eigen::VectorXd measured =
        input.distributions.matrix().col(indices[k]).cast<double>();
    worst = std::max(worst, (refined - expected.col(Eigen::Index(k))).norm());
    change = std::max(change, (refined - measured).norm());
  }
  return {worst, change};
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
    addCliques(crf, model, cliquesThatTakePart(), parameters);
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
  // Weights of 8 bits in the kernels, of which three updates make more.
  const auto [worst, change] =
      errorAndChange(crf, setting.input, setting.indices,
                     plainMarginals(plain, setting.parameters.iterations));
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

// With Potts' compatibility and a full one, and with the hierarchical model's options.
TEST(CRFModels, EqualThePlainOnes)
{
  Setting setting;
  const Eigen::MatrixXf half = makeRandomMatrix(4, 4, -0.2f, 0.6f, 13);
  for (const CRFModelType model : every_model) {
    Filter crf;
    setting.prepare(crf, model);
    PlainCrf plain = setting.plain(model);
    expectEqualsPlain(setting, crf, plain, std::to_string(int(model)));
    const bool uses_cliques = model != CRFModelType::dense;
    EXPECT_EQ(crf.getReport().skipped_cliques, uses_cliques ? 1u : 0u);
    EXPECT_EQ(crf.getReport().cliques,
              uses_cliques ? setting.cliquesThatTakePart().size() : 0u);
    EXPECT_EQ(crf.getReport().updates, 3);
    plain.compatibility = half;
    crf.setCompatibility(half);
    expectEqualsPlain(setting, crf, plain, "full " + std::to_string(int(model)));
  }
  for (const auto& [free_label, truncation] :
       {std::pair(false, setting.parameters.clique_truncation), {true, 0.8}}) {
    setting.parameters.free_label = free_label;
    setting.parameters.clique_truncation = truncation;
    Filter crf;
    setting.prepare(crf, CRFModelType::hierarchical);
    expectEqualsPlain(setting, crf, setting.plain(CRFModelType::hierarchical),
                      std::to_string(truncation));
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
  EXPECT_LT(largestDifference(crf.getLabelDistributions().matrix(), measured), 1e-6f);
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
  EXPECT_GT(largestDifference(crf.getLabelDistributions().matrix(), with), 0.02f);
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
  EXPECT_LT(largestDifference(own.getLabelDistributions().matrix(),
                              usual.getLabelDistributions().matrix()),
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
    SemanticCRFParameters parameters;
    parameters.iterations = 8;
    Filter crf = filterWith(parameters);
    Cloud output;
    refine(crf, input, &output);
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

// Weights of a truncated kernel have 8 bits, so a message may be off by 1/128 of it:
// with those of this cloud that is up to 0.01 of a marginal.
constexpr double tolerance = 0.01;

LabelDistributions
refinedBy(const SemanticCRFParameters& parameters, const CrfCloud& input,
          const std::vector<Label>& thin = {})
{
  CrfFilter crf = filterWith(parameters);
  crf.setThinLabels(thin);
  refine(crf, input);
  return crf.getLabelDistributions();
}

TEST(SemanticCRF, EqualsThePlainModel)
{
  const CrfCloud input = makeCrfCloud(400, 1);
  for (const int iterations : {1, 3}) {
    SemanticCRFParameters parameters;
    parameters.iterations = iterations;
    CrfFilter crf = filterWith(parameters);
    Cloud output;
    const Eigen::MatrixXd refined = refine(crf, input, &output).cast<double>();
    const Eigen::MatrixXd expected = plainMarginals(
        makePlainCrf(input, allIndices(400), SemanticCRFParameters()), iterations);
    EXPECT_LT((refined - expected).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LT((refined - expected).cwiseAbs().mean(), tolerance / 10);
    for (std::size_t i = 0; i < output.size(); ++i)
      EXPECT_EQ(output[i].label, crf.getLabelDistributions().mapLabel(Eigen::Index(i)));
    EXPECT_EQ(output[0].getVector3fMap(), (*input.cloud)[0].getVector3fMap());
    EXPECT_EQ(output[0].rgba, (*input.cloud)[0].rgba);
  }
}

TEST(SemanticCRF, ATemperatureMakesProbabilitiesLessSureAndKeepsLabels)
{
  const CrfCloud input = makeCrfCloud(300, 4);
  const auto refine = [&](double temperature) {
    SemanticCRFParameters parameters;
    parameters.temperature = temperature;
    return refinedBy(parameters, input);
  };
  const LabelDistributions sure = refine(1.0), tempered = refine(3.0);
  const LabelDistributions hot = refine(1000.0);
  for (Eigen::Index i = 0; i < sure.size(); ++i) {
    Eigen::ArrayXd expected =
        sure.matrix().col(i).cast<double>().array().max(1e-30).pow(1.0 / 3.0);
    expected /= expected.sum();
    EXPECT_LT(
        (tempered.matrix().col(i).cast<double>().array() - expected).abs().maxCoeff(),
        1e-5);
    EXPECT_EQ(tempered.mapLabel(i), sure.mapLabel(i));
    EXPECT_EQ(hot.mapLabel(i), sure.mapLabel(i)); // where classes are nearly alike
  }
}

TEST(SemanticCRF, ThinThingsStayWhatTheyWereMeasuredAsUnlessMuchOutvoted)
{
  const CrfCloud input = makeCrfCloud(300, 5);
  const auto refine = [&](double weight, bool keep, const std::vector<Label>& thin) {
    SemanticCRFParameters parameters;
    parameters.smoothness_weight = weight;
    parameters.keep_thin = keep;
    return refinedBy(parameters, input, thin);
  };
  int kept_others = 0, outvoted = 0;
  for (const double weight : {3.0, 400.0}) {
    const LabelDistributions all = refine(weight, true, {});
    const LabelDistributions kept = refine(weight, true, {2});
    EXPECT_TRUE(refine(weight, false, {2}).matrix() == all.matrix());
    for (Eigen::Index i = 0; i < kept.size(); ++i) {
      const Eigen::VectorXf marginal = all.matrix().col(i);
      const Eigen::VectorXf measured = input.distributions.matrix().col(i) /
                                       input.distributions.matrix().col(i).sum();
      const int winner = int(all.mapLabel(i)) - 1;
      const double odds = double(marginal[winner]) * measured[1] /
                          (double(marginal[1]) * std::max(measured[winner], 1e-6f));
      if (input.distributions.mapLabel(i) == 2 && odds < 403.0) {
        EXPECT_LT((kept.matrix().col(i) - measured).norm(), 1e-6f);
        kept_others += winner != 1;
      }
      else if (input.distributions.mapLabel(i) != 2 || odds > 404.0) {
        EXPECT_TRUE(kept.matrix().col(i) == marginal);
        outvoted += odds > 404.0;
      }
    }
  }
  EXPECT_GT(kept_others, 5);
  EXPECT_GT(outvoted, 5);
}

TEST(SemanticCRF, ThinLabelsAreClassesThatThereAre)
{
  const CrfCloud input = makeCrfCloud(40, 1);
  const int classes = input.distributions.classes();
  for (const int label : {0, classes + 1, 200})
    expectBadParameter("thin labels: " + std::to_string(label) + ", expected 1 to " +
                           std::to_string(classes),
                       [&] {
                         refinedBy(SemanticCRFParameters(), input, {1, Label(label)});
                       });
}

TEST(SemanticCRF, AnUnlabelledPointTakesTheLabelOfItsNeighboursIfThereIsOne)
{
  CrfCloud line = makeCrfCloud(30, 4), groups = makeCrfCloud(30, 4);
  for (int i = 0; i < 30; ++i) { // the second: two far apart, one without any label
    (*line.cloud)[std::size_t(i)].getVector3fMap() << 0.1f * float(i), 0.0f, 0.0f;
    line.distributions.setLabel(i, i == 15 ? 0 : 3, 0.9f);
    (*groups.cloud)[std::size_t(i)].getVector3fMap() << 0.1f * float(i % 15),
        i < 15 ? 0.0f : 50.0f, 0.0f;
    groups.distributions.setLabel(i, i < 15 ? 0 : 3, 0.9f);
  }
  Cloud output;
  CrfFilter usual;
  refine(usual, line, &output);
  EXPECT_EQ(output[15].label, 3u);
  for (const int iterations : {0, 1, 5}) {
    SemanticCRFParameters parameters;
    parameters.iterations = iterations;
    CrfFilter crf = filterWith(parameters);
    EXPECT_EQ(refine(crf, groups, &output).leftCols(15).sum(), 0.0f);
    for (int i = 0; i < 30; ++i)
      EXPECT_EQ(output[std::size_t(i)].label, i < 15 ? 0u : 3u) << i;
  }
}

struct Problem {
  CrfCloud input;
  pcl::Indices indices;                           // of points that take part
  std::vector<std::vector<std::int32_t>> members; // of cliques, in numbers of these
  Eigen::MatrixXf compatibility;                  // empty = Potts
  CRFModelType model = CRFModelType::dense;
  SemanticCRFParameters parameters;
};

class Random {
public:
  explicit Random(unsigned seed) : engine_(seed) {}

  int
  below(int end)
  {
    return int(engine_() % unsigned(end));
  }

  bool
  flip()
  {
    return below(2) == 0;
  }

  double
  between(double low, double high)
  {
    return low + (high - low) * double(engine_()) / double(std::mt19937::max());
  }

private:
  std::mt19937 engine_;
};

SemanticCRFParameters
randomParameters(Random& random)
{
  SemanticCRFParameters parameters;
  const auto weight = [&] { return random.below(5) == 0 ? 0.0 : random.between(0, 4); };
  const auto deviation = [&] { return random.flip() ? 0.0 : random.between(0.1, 0.5); };
  parameters.smoothness_weight = weight();
  parameters.smoothness_deviation = deviation();
  parameters.appearance_weight = weight();
  parameters.appearance_deviation = deviation();
  parameters.colour_deviation = random.between(3, 20);
  parameters.kernel_method = KernelMethod::truncated; // the other one approximates
  parameters.radius = random.between(1, 3);
  parameters.normalization = Normalization(random.below(3));
  if (parameters.normalization == Normalization::none) { // sums of many neighbours
    parameters.smoothness_weight *= 0.1;
    parameters.appearance_weight *= 0.1;
  }
  parameters.self_interaction = random.flip();
  parameters.iterations = 1 + random.below(3);
  parameters.temperature = random.flip() ? 1.0 : random.between(1, 4);
  parameters.clique_weight = random.between(0, 2);
  parameters.free_label = random.flip();
  parameters.clique_truncation = random.between(0.1, 0.5);
  parameters.clique_start = random.flip();
  return parameters;
}

Problem
randomProblem(unsigned seed)
{
  Random random(seed);
  const int size = 20 + random.below(60);
  Problem problem;
  problem.input = makeCrfCloud(size, seed);
  for (int i = 0; i < size; ++i)
    if (random.below(6) != 0)
      problem.indices.push_back(i);
  const int taking_part = int(problem.indices.size());
  problem.members =
      makeCliques(1 + random.below(8), 1 + random.below(10), taking_part, seed + 1);
  problem.model = every_model[random.below(3)];
  problem.parameters = randomParameters(random);
  if (random.below(3) == 0)
    problem.compatibility = makeRandomMatrix(4, 4, -0.2f, 0.6f, seed + 2);
  return problem;
}

struct PlainResult {
  Eigen::MatrixXd distributions;
  double tolerance = 0.0; // what kernels with weights of 8 bits may make of these
};

PlainResult
plainResult(const Problem& problem)
{
  const SemanticCRFParameters& parameters = problem.parameters;
  PlainCrf crf = makePlainCrf(problem.input, problem.indices, parameters);
  crf.compatibility = problem.compatibility;
  if (parameters.appearance_weight == 0.0) // it is left out
    crf.kernels.erase(crf.kernels.begin() + 1);
  if (parameters.smoothness_weight == 0.0)
    crf.kernels.erase(crf.kernels.begin());
  addCliques(crf, problem.model, problem.members, parameters);
  const Eigen::MatrixXd q = plainMarginals(crf, parameters.iterations);
  Eigen::MatrixXd result =
      q.array().max(1e-300).pow(1.0 / parameters.temperature).matrix();
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) /= result.col(i).sum();
  double heard = 0.0; // maximum sum of the messages to a point
  for (const Eigen::MatrixXf& kernel : crf.kernels)
    heard += double(kernel.rowwise().sum().maxCoeff());
  return {result, 1e-3 + parameters.iterations * heard / 256.0};
}

TEST(CRFOracle, TwoHundredRandomProblemsEqualAPlainMeanField)
{
  int changed = 0, looser = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Problem problem = randomProblem(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", model " +
                 std::to_string(int(problem.model)));
    Filter crf;
    crf.setModel(problem.model);
    crf.setParameters(problem.parameters);
    crf.setInputCloud(problem.input.cloud);
    crf.setIndices(std::make_shared<pcl::Indices>(problem.indices));
    crf.setLabelDistributions(problem.input.distributions);
    std::vector<std::vector<std::int32_t>> cliques = problem.members;
    for (auto& members : cliques)
      for (std::int32_t& member : members)
        member = problem.indices[std::size_t(member)];
    crf.setCliques(toPcl(cliques));
    if (problem.compatibility.size() > 0)
      crf.setCompatibility(problem.compatibility);
    Cloud output;
    crf.filter(output);
    const PlainResult expected = plainResult(problem);
    const auto [worst, change] =
        errorAndChange(crf, problem.input, problem.indices, expected.distributions);
    ASSERT_TRUE(expected.distributions.allFinite());
    EXPECT_LT(worst, expected.tolerance);
    looser += expected.tolerance > 0.1;
    changed += change > 0.1;
  }
  EXPECT_GT(changed, 150) << "most of them change something";
  EXPECT_LT(looser, 20) << "or the bound says nothing";
}

} // namespace
