// SPDX-License-Identifier: BSD-3-Clause

// Random small problems with random settings, against mean field written out in double
// precision. A seed that fails is in the message.

#include "support/plain_cloud_crf.h"
#include "support/plain_mean_field.h"
#include "support/random_crf.h"

#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

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
  parameters.update_from_members = random.flip();
  return parameters;
}

Problem
randomProblem(unsigned seed)
{
  Random random(seed);
  const int points = 20 + random.below(60);
  Problem problem;
  problem.input = makeCrfCloud(points, seed);
  for (int i = 0; i < points; ++i)
    if (random.below(6) != 0)
      problem.indices.push_back(i);
  const int taking_part = int(problem.indices.size());
  problem.members =
      makeCliques(1 + random.below(8), 1 + random.below(10), taking_part, seed + 1);
  const CRFModelType models[] = {CRFModelType::dense, CRFModelType::pn_potts,
                                 CRFModelType::hierarchical};
  problem.model = models[random.below(3)];
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
  if (problem.model != CRFModelType::dense) {
    PlainCliques cliques;
    cliques.type = problem.model == CRFModelType::pn_potts
                       ? CliquePotential::Type::pn_potts
                       : CliquePotential::Type::robust;
    cliques.members = problem.members;
    cliques.weights.setConstant(1, 1, float(parameters.clique_weight));
    cliques.free_label = parameters.free_label;
    cliques.truncation = float(parameters.clique_truncation);
    cliques.update_from_members = parameters.update_from_members;
    crf.cliques.push_back(cliques);
  }
  PlainMeanField field(crf);
  for (int i = 0; i < parameters.iterations; ++i)
    field.update();
  Eigen::MatrixXd result =
      field.q.array().max(1e-300).pow(1.0 / parameters.temperature).matrix();
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) /= result.col(i).sum();
  double heard = 0.0; // maximum sum of the messages to a point
  for (const Eigen::MatrixXf& kernel : crf.kernels)
    heard += double(kernel.rowwise().sum().maxCoeff());
  return {result, 1e-3 + parameters.iterations * heard / 256.0};
}

} // namespace

TEST(CRFOracle, TwoHundredRandomProblemsEqualAPlainMeanField)
{
  int changed = 0, looser = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const Problem problem = randomProblem(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", model " +
                 std::to_string(int(problem.model)));
    SemanticCRF<pcl::PointXYZRGBL> crf;
    crf.setModel(problem.model);
    crf.setParameters(problem.parameters);
    crf.setInputCloud(problem.input.cloud);
    crf.setIndices(std::make_shared<pcl::Indices>(problem.indices));
    crf.setLabelDistributions(problem.input.distributions);
    std::vector<pcl::PointIndices> cliques;
    for (const auto& members : problem.members) {
      cliques.emplace_back();
      for (const std::int32_t member : members)
        cliques.back().indices.push_back(problem.indices[std::size_t(member)]);
    }
    crf.setCliques(cliques);
    if (problem.compatibility.size() > 0)
      crf.setCompatibility(problem.compatibility);
    pcl::PointCloud<pcl::PointXYZRGBL> output;
    crf.filter(output);
    const PlainResult expected = plainResult(problem);
    double worst = 0.0, change = 0.0;
    for (std::size_t k = 0; k < problem.indices.size(); ++k) {
      const Eigen::Index i = problem.indices[k];
      const Eigen::VectorXd refined =
          crf.getLabelDistributions().matrix().col(i).cast<double>();
      const Eigen::VectorXd measured =
          problem.input.distributions.matrix().col(i).cast<double>();
      worst = std::max(worst,
                       (refined - expected.distributions.col(Eigen::Index(k))).norm());
      change = std::max(change, (refined - measured).norm());
    }
    ASSERT_TRUE(expected.distributions.allFinite());
    EXPECT_LT(worst, expected.tolerance);
    looser += expected.tolerance > 0.1;
    changed += change > 0.1;
  }
  EXPECT_GT(changed, 150) << "most of them change something";
  EXPECT_LT(looser, 20) << "or the bound says nothing";
}

} // namespace pcl_semantic
