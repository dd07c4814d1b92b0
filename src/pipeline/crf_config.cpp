// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/crf_config.h>

#include "cliques/slic_cliques.h"
#include "config_checks.h"
#include "core/fail.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <cmath>

namespace pcl_semantic {

namespace {

double
numberAfterColon(const std::string& text)
{
  try {
    return parseNumber(text.substr(text.find(':') + 1), "cliques '" + text + "'");
  }
  catch (const BadInputException& error) {
    badParameter(error.what());
  }
}

// `word` or `word:NUMBER`; false if the text is something else.
bool
parseSuperpixels(const std::string& text, const std::string& word,
                 SlicParameters& parameters)
{
  if (text == word)
    return true;
  if (text.rfind(word + ":", 0) != 0)
    return false;
  const double number = numberAfterColon(text);
  if (!(number >= 1.0 && number <= 65536.0) || number != std::floor(number))
    badParameter("cliques are '", text, "', expected ", word, ":N with N 1 to 65536");
  parameters.superpixels = int(number);
  return true;
}

} // namespace

void
CliqueParameters::validate() const
{
  superpixel.validate();
  supervoxel.validate();
}

ConfigParameters
parametersOf(CliqueParameters& parameters)
{
  SuperpixelParameters& superpixel = parameters.superpixel;
  return {{"superpixel_keep",
           "keep voxels that are out of view in their last superpixel",
           &superpixel.keep, "false"},
          {"superpixel_depth_jump",
           "split superpixels where the line through the points of neighbouring pixels "
           "passes the camera closer than this [m]; 0 = off",
           &superpixel.passing_distance}};
}

bool
parseSlic(const std::string& text, SlicParameters& parameters)
{
  return parseSuperpixels(text, "slic", parameters);
}

bool
namesCloudCliques(const std::string& text)
{
  const std::string word = text.substr(0, text.find(':'));
  return word == "cubes" || word == "slic" || word == "supervoxel";
}

CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text, const CliqueParameters& parameters)
{
  SuperpixelParameters superpixel = parameters.superpixel;
  if (text == "cubes")
    return std::make_shared<CubeCliques>();
  if (text.rfind("cubes:", 0) == 0)
    return std::make_shared<CubeCliques>(numberAfterColon(text));
  if (parseSlic(text, superpixel.slic))
    return std::make_shared<SlicCliques>(superpixel.slic);
  if (parseSuperpixels(text, "superpixel", superpixel.slic))
    return std::make_shared<SuperpixelCliques>(superpixel);
  if (text == "supervoxel" || text.rfind("supervoxel:", 0) == 0) {
    SupervoxelParameters supervoxel = parameters.supervoxel;
    if (text != "supervoxel")
      supervoxel.seed_resolution = numberAfterColon(text);
    return std::make_shared<SupervoxelCliques>(supervoxel);
  }
  badParameter("cliques are '", text,
               "', expected cubes[:SIZE], slic, superpixel or "
               "supervoxel");
}

namespace {

ConfigParameters
cliqueParametersOf(SemanticCRFParameters& crf)
{
  return {
      {"clique_weight", "k_c, cost of a member whose label differs from its clique's",
       &crf.clique_weight},
      {"clique_free_label",
       "whether cliques have the free label, eq. (7): true or false", &crf.free_label},
      {"clique_truncation",
       "fraction of members that may differ before the free label is cheaper",
       &crf.clique_truncation},
      {"clique_update_from_members",
       "whether members update their clique, eq. (10): true or false",
       &crf.update_from_members},
      {"clique_appearance_weight",
       "weight of the kernel between cliques, over their mean positions and colours; 0 "
       "= off",
       &crf.clique_appearance_weight}};
}

} // namespace

ConfigParameters
parametersOf(SemanticCRFParameters& crf, const std::string& unit)
{
  ConfigParameters parameters = {
      {"crf_iterations", "number of mean-field updates", &crf.iterations},
      {"crf_temperature",
       "temperature of the resulting probabilities: above 1 they are less sure, labels "
       "stay",
       &crf.temperature},
      {"crf_keep_thin",
       "whether what was measured as a class marked thin in the label set stays one "
       "unless much outvoted: true or false",
       &crf.keep_thin},
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
       "its standard deviation [" + unit + "]; 0 = from the distance of the points",
       &crf.smoothness_deviation},
      {"appearance_weight",
       "weight of the appearance kernel (positions and colours; without colours "
       "positions alone)",
       &crf.appearance_weight},
      {"appearance_deviation",
       "its standard deviation of positions [" + unit +
           "]; 0 = from the distance of the points",
       &crf.appearance_deviation},
      {"colour_deviation", "its standard deviation of colours [grey levels]",
       &crf.colour_deviation}};
  append(parameters, cliqueParametersOf(crf));
  return parameters;
}

void
CRFConfig::validate() const
{
  parameters.validate();
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
      {"crf", "unary, dense, pn-potts or hierarchical",
       chooseFrom(config.model, {"unary", "dense", "pn-potts", "hierarchical"})},
      {"cliques", config.clique_words, &config.cliques},
      {"label_confidence", "probability of the class that a label gives",
       &config.label_confidence}};
  append(parameters, parametersOf(config.parameters, config.unit));
  parameters.push_back(
      {"threads", "number of threads; 0 = all processors", &config.threads});
  return parameters;
}

void
readCRFConfig(const std::string& path, CRFConfig& config)
{
  readConfig(path, config);
}

} // namespace pcl_semantic
