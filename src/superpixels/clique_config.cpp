// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/superpixels/clique_config.h>

#include "slic_cliques.h"

#include "core/fail.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parse_number.h>

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

// Parses `word` or `word:NUMBER`; false for any other text.
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
  return {
      {"superpixel_keep",
       "keep voxels in their last superpixel while they are out of view: true or false",
       &superpixel.keep, "false"},
      {"superpixel_depth_jump",
       "minimum distance from the camera to the line through the points of "
       "neighbouring pixels [m]; superpixels are split at closer lines; 0 = off",
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

} // namespace pcl_semantic
