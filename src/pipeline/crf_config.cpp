// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/crf_config.h>

namespace pcl_semantic {

namespace {

void
append(ConfigParameters& to, ConfigParameters from)
{
  for (ConfigParameter& parameter : from)
    to.push_back(std::move(parameter));
}

ConfigParameters
cliqueParametersOf(SemanticCRFParameters& crf, const std::string& unit)
{
  return {{"clique_weight", "k_c, what a member pays that differs from its clique",
           &crf.clique_weight},
          {"clique_free_label", "a clique may let go of its members", &crf.free_label},
          {"clique_truncation", "share of members that may differ before it does",
           &crf.clique_truncation},
          {"clique_hears_members", "it does not keep to what its own costs say",
           &crf.cliques_hear_members},
          {"clique_members_hear_map", "its MAP label alone, not its distribution",
           &crf.members_hear_map},
          {"clique_smoothness_weight", "of the kernel of the cliques' mean positions",
           &crf.clique_smoothness_weight},
          {"clique_smoothness_deviation", "of positions, in that kernel [" + unit + "]",
           &crf.clique_smoothness_deviation},
          {"clique_appearance_weight",
           "of the kernel of their mean positions and colours",
           &crf.clique_appearance_weight},
          {"clique_appearance_deviation", "of positions, in that kernel [" + unit + "]",
           &crf.clique_appearance_deviation},
          {"clique_colour_deviation", "of colours, in that kernel [grey levels]",
           &crf.clique_colour_deviation}};
}

} // namespace

ConfigParameters
parametersOf(SemanticCRFParameters& crf, const std::string& unit)
{
  ConfigParameters parameters = {
      {"crf_iterations", "mean-field updates a run, at most", &crf.iterations},
      {"crf_settled", "stop when no probability changed by more; 0 = never",
       &crf.settled},
      {"crf_kernels", "automatic, truncated (sums over near pairs) or lattice",
       chooseFrom(crf.kernel_method, {"automatic", "truncated", "lattice"})},
      {"crf_radius", "truncated sums reach this many deviations", &crf.radius},
      {"crf_normalization", "of kernels: symmetric, one-sided or none",
       chooseFrom(crf.normalization, {"symmetric", "one-sided", "none"})},
      {"crf_self_interaction", "points hear themselves, as in densecrf",
       &crf.self_interaction},
      {"smoothness_weight", "of the kernel of positions", &crf.smoothness_weight},
      {"smoothness_deviation", "of positions, in that kernel [" + unit + "]",
       &crf.smoothness_deviation},
      {"appearance_weight", "of the kernel of positions and colours",
       &crf.appearance_weight},
      {"appearance_deviation", "of positions, in that kernel [" + unit + "]",
       &crf.appearance_deviation},
      {"colour_deviation", "of colours, in that kernel [grey levels]",
       &crf.colour_deviation}};
  append(parameters, cliqueParametersOf(crf, unit));
  return parameters;
}

void
CRFConfig::validate() const
{
  parameters.validate();
  if (!(label_confidence > 0.0 && label_confidence <= 1.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "label_confidence is " << label_confidence
                                               << ", expected more than 0, at most 1");
}

void
CRFConfig::requireFittingCliques() const
{
  const bool needed =
      model == CRFModelType::pn_potts || model == CRFModelType::hierarchical;
  if (needed != (cliques != "none"))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        (needed ? "the models pn-potts and hierarchical need cliques: "
                                : "cliques are for the models pn-potts and "
                                  "hierarchical, not with: ")
                            << "--cliques " << cliques);
}

ConfigParameters
parametersOf(CRFConfig& config)
{
  ConfigParameters parameters = {
      {"crf", "unary, dense, pn-potts or hierarchical",
       chooseFrom(config.model, {"unary", "dense", "pn-potts", "hierarchical"})},
      {"cliques", config.clique_words, &config.cliques},
      {"label_confidence", "probability of the class that a label states",
       &config.label_confidence}};
  append(parameters, parametersOf(config.parameters, config.unit));
  parameters.push_back({"threads", "0 = all processors", &config.threads});
  return parameters;
}

void
readCRFConfig(const std::string& path, CRFConfig& config)
{
  if (path.empty())
    return;
  readParameters(path, parametersOf(config));
  try {
    config.validate();
  }
  catch (const InvalidParameterException& error) {
    PCL_THROW_EXCEPTION(BadInputException, path << ": " << error.what());
  }
}

} // namespace pcl_semantic
