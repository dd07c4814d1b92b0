// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/filters/crf_config.h>

#include "core/config_checks.h"
#include "core/fail.h"

namespace pcl_semantic {

namespace {

ConfigParameters
cliqueParametersOf(SemanticCRFParameters& crf)
{
  return {
      {"clique_weight",
       "cost k_c of a member whose label differs from its clique's label",
       &crf.clique_weight},
      {"clique_start",
       "whether the first update of the kernels uses the messages of the cliques: true "
       "or false (as in the paper)",
       &crf.clique_start},
      {"clique_free_label",
       "whether cliques have the free label, eq. (7): true or false", &crf.free_label},
      {"clique_truncation",
       "fraction of members that may differ before the free label is cheaper",
       &crf.clique_truncation},
      {"clique_appearance_weight",
       "weight of the kernel between cliques, over their mean positions and colours; 0 "
       "= off",
       &crf.clique_appearance_weight}};
}

} // namespace

ConfigParameters
parametersOf(SemanticCRFParameters& crf, const std::string& unit)
{
  const bool is_cloud = unit == "m";
  const std::string or_automatic = is_cloud ? "; 0 = by the sensor" : "";
  ConfigParameters parameters = {
      {"crf_iterations", "number of mean-field updates" + or_automatic,
       &crf.iterations},
      {"crf_temperature",
       "temperature of the resulting probabilities; above 1 they are less confident, "
       "labels do not change",
       &crf.temperature},
      {"crf_keep_thin",
       "whether measured labels of classes marked thin in the label set stay unless "
       "neighbours strongly outvote them: true or false",
       &crf.keep_thin},
      {"crf_logit_adjustment",
       "power of the frequencies of the classes that measurements are divided by, so "
       "that rare classes survive; 0 = off, -1 = by the sensor",
       &crf.logit_adjustment},
      {"crf_kernels",
       "evaluation of the kernels: automatic, truncated (exact within a radius) or "
       "lattice",
       chooseFrom(crf.kernel_method, {"automatic", "truncated", "lattice"}),
       "automatic"},
      {"crf_normalization",
       "normalisation of the kernels: symmetric, one-sided or none",
       chooseFrom(crf.normalization, {"symmetric", "one-sided", "none"})},
      {"crf_self_interaction",
       "whether kernels include the point itself, as densecrf does: true or false",
       &crf.self_interaction, "false"},
      {"smoothness_weight", "weight of the smoothness kernel (positions)",
       &crf.smoothness_weight},
      {"smoothness_deviation",
       "standard deviation of positions in the smoothness kernel [" + unit +
           "]; 0 = by the sensor and the distance of the points",
       &crf.smoothness_deviation},
      {"appearance_weight",
       "weight of the appearance kernel (positions and colours; only positions if "
       "there are no colours)",
       &crf.appearance_weight},
      {"appearance_deviation",
       "standard deviation of positions in the appearance kernel [" + unit +
           "]; 0 = by the sensor and the distance of the points",
       &crf.appearance_deviation},
      {"colour_deviation",
       "standard deviation of colours in the appearance kernel [grey levels]" +
           or_automatic,
       &crf.colour_deviation}};
  if (is_cloud)
    parameters.push_back(
        {"crf_sensor",
         "sensor of the points, for automatic updates and deviations: automatic (of "
         "a map: its sensor; of a cloud: rgbd if it has colours, otherwise lidar), "
         "stereo, rgbd or lidar",
         chooseFrom(crf.sensor, {"automatic", "stereo", "rgbd", "lidar"})});
  append(parameters, cliqueParametersOf(crf));
  return parameters;
}

void
CRFConfig::validate() const
{
  parameters.validate();
  const auto requireValue = [this](const char* name, double value) {
    if (unit != "m" && value == 0.0) // automatic values are for clouds
      badParameter(name, " is 0, expected more than 0");
  };
  requireValue("crf_iterations", parameters.iterations);
  requireValue("smoothness_deviation", parameters.smoothness_deviation);
  requireValue("appearance_deviation", parameters.appearance_deviation);
  requireValue("colour_deviation", parameters.colour_deviation);
  requireConfidence(label_confidence);
}

void
CRFConfig::requireFittingCliques() const
{
  const bool needed =
      model == CRFModelType::pn_potts || model == CRFModelType::hierarchical;
  if (needed != (cliques != "none"))
    badParameter((needed ? "the models pn-potts and hierarchical need cliques: "
                         : "cliques are for the models pn-potts and "
                           "hierarchical, not with: "),
                 "--cliques ", cliques);
}

ConfigParameters
parametersOf(CRFConfig& config)
{
  ConfigParameters parameters = {
      {"crf", "CRF model: unary, dense, pn-potts or hierarchical",
       chooseFrom(config.model, {"unary", "dense", "pn-potts", "hierarchical"})},
      {"cliques", config.clique_words, &config.cliques},
      {"label_confidence", "probability of the class of a label",
       &config.label_confidence}};
  append(parameters, parametersOf(config.parameters, config.unit));
  parameters.push_back(
      {"threads", "number of threads; 0 = all processors", &config.threads});
  return parameters;
}

} // namespace pcl_semantic
