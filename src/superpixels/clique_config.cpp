// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/superpixels/clique_config.h>

#include "slic_cliques.h"

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/cliques/ranked_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parse_number.h>
#include <pcl_semantic/things/plane_cliques.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

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

std::vector<std::string>
partsOf(const std::string& text)
{
  const std::vector<std::string_view> views = splitAt(',', text);
  std::vector<std::string> parts(views.begin(), views.end());
  if (text.empty() || text.back() == ',') // splitAt() drops an empty last part
    parts.emplace_back();
  return parts;
}

std::string
wordOf(const std::string& part)
{
  return part.substr(0, part.find(':'));
}

CliqueGenerator::Ptr
makeOne(const std::string& text, const CliqueParameters& parameters)
{
  const std::string word = wordOf(text);
  const bool has_number = word.size() < text.size();
  SuperpixelParameters superpixel = parameters.superpixel;
  if (word == "cubes")
    return has_number ? std::make_shared<CubeCliques>(numberAfterColon(text))
                      : std::make_shared<CubeCliques>();
  if (word == "planes")
    return has_number ? std::make_shared<PlaneCliques>(numberAfterColon(text))
                      : std::make_shared<PlaneCliques>();
  if (parseSlic(text, superpixel.slic))
    return std::make_shared<SlicCliques>(superpixel.slic);
  if (parseSuperpixels(text, "superpixel", superpixel.slic))
    return std::make_shared<SuperpixelCliques>(superpixel);
  if (word == "supervoxel") {
    SupervoxelParameters supervoxel = parameters.supervoxel;
    if (has_number)
      supervoxel.seed_resolution = numberAfterColon(text);
    return std::make_shared<SupervoxelCliques>(supervoxel);
  }
  badParameter(
      "cliques are '", text,
      "', expected planes[:EDGE], cubes[:EDGE], slic, superpixel or supervoxel");
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
namesCliques(const std::string& text, const std::string& word)
{
  const std::vector<std::string> parts = partsOf(text);
  return std::any_of(parts.begin(), parts.end(),
                     [&](const std::string& part) { return wordOf(part) == word; });
}

bool
namesCloudCliques(const std::string& text)
{
  const std::vector<std::string> parts = partsOf(text);
  return std::all_of(parts.begin(), parts.end(), [](const std::string& part) {
    const std::string word = wordOf(part);
    return word == "cubes" || word == "planes" || word == "slic" ||
           word == "supervoxel";
  });
}

CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text, const CliqueParameters& parameters)
{
  const std::vector<std::string> parts = partsOf(text);
  if (parts.size() == 1)
    return makeOne(text, parameters);
  if (std::find(parts.begin(), parts.end(), "") != parts.end())
    badParameter("cliques are '", text,
                 "', expected a method before and after a comma");
  std::vector<CliqueGenerator::Ptr> generators;
  for (const std::string& part : parts)
    generators.push_back(makeOne(part, parameters));
  return std::make_shared<RankedCliques>(std::move(generators));
}

} // namespace pcl_semantic
