// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/stereo/disparity_engines.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

const std::vector<std::string> crf_models = {"none", "dense", "pn-potts",
                                             "hierarchical"};

void
requireChoice(const std::string& value, const std::vector<std::string>& choices,
              const char* name)
{
  if (std::count(choices.begin(), choices.end(), value))
    return;
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      name << " is '" << value << "', expected " << joinWords(choices));
}

} // namespace

void
MapperConfig::validate()
{
  requireChoice(pixel_fusion, {"mean", "product"}, "pixel_fusion");
  requireChoice(crf, crf_models, "crf");
  SlicParameters slic;
  if (parseSlic(cliques, slic)) // is for organized clouds
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "cliques are '"
                            << cliques
                            << "', expected cubes:SIZE, superpixel or supervoxel");
  makeCliqueGenerator(cliques, clique_parameters);
  map.fusion.pixel_fusion =
      pixel_fusion == "mean" ? PixelFusion::mean : PixelFusion::product;
  if (!(map.max_range > 0.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "max_depth is " << map.max_range << " m, expected more than 0");
  map.validate();
  crf_parameters.validate();
  makeDisparityEstimator(stereo, disparities); // checks both
  for (const auto& [name, value] : {std::pair("max_deviation", max_deviation),
                                    std::pair("deviation_scale", deviation_scale)})
    if (!(value >= 0.0 && value <= 100.0))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          name << " is " << value << ", expected 0 to 100");
  if (!(hit_share >= 0.0 && hit_share <= 1.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "hit_share is " << hit_share << ", expected 0 to 1");
  if (crf_every < 1)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "crf_every is " << crf_every << ", expected 1 or more");
  if (!(clique_leaves_out_above >= 0.0 && clique_leaves_out_above <= 1.0))
    PCL_THROW_EXCEPTION(InvalidParameterException, "clique_leaves_out_above is "
                                                       << clique_leaves_out_above
                                                       << ", expected 0 to 1");
  if (!(label_confidence > 0.0 && label_confidence <= 1.0))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "label_confidence is " << label_confidence
                                               << ", expected more than 0, at most 1");
}

ConfigParameters
parametersOf(MapperConfig& config)
{
  FusionParameters& fusion = config.map.fusion;
  ConfigParameters parameters = {
      {"stereo", "engine: " + joinWords(disparityEngines()), &config.stereo},
      {"disparities", "range of the stereo search, a multiple of 64 [px]",
       &config.disparities},
      {"max_deviation",
       "disparities with a larger standard deviation give no depth [px]; 0 = all do",
       &config.max_deviation},
      {"deviation_scale",
       "nothing is cleared within two deviations of a depth, times this; 0 = always",
       &config.deviation_scale},
      {"hit_share",
       "share of the pixels that see a voxel or look past it that must hit it; 0 = one "
       "does",
       &config.hit_share},
      {"label_confidence", "probability of the class that a stored .png states",
       &config.label_confidence},
      {"voxel_size", "edge of a voxel [m]", &config.map.voxel_size},
      {"window", "extent of the window around the camera: X,Y,Z, world axes [m]",
       &config.map.window},
      {"max_depth", "pixels beyond this depth only clear space [m]",
       &config.map.max_range},
      {"hit_probability", "of being occupied, given a hit", &fusion.hit_probability},
      {"miss_probability", "of being occupied, given a ray through it",
       &fusion.miss_probability},
      {"min_probability", "clamp of occupancy from below", &fusion.min_probability},
      {"max_probability", "clamp of occupancy from above", &fusion.max_probability},
      {"occupied_probability", "occupied at or above", &fusion.occupied_probability},
      {"per_ray_counting", "every ray counts, as in the paper: true or false",
       &fusion.per_ray_counting},
      {"dynamic_decay", "log-odds that voxels of dynamic classes lose at each frame",
       &fusion.dynamic_decay},
      {"pixel_fusion", "pixels of a frame in one voxel: mean or product",
       &config.pixel_fusion},
      {"label_min_probability", "clamp of each label measurement from below",
       &fusion.label_min_probability},
      {"label_max_ratio", "clamp of a fused distribution: largest / smallest",
       &fusion.label_max_ratio},
      {"crf", "model: " + joinWords(crf_models), &config.crf},
      {"crf_every", "the CRF runs at the first and every N-th frame after it",
       &config.crf_every},
      {"crf_write_back",
       "what the CRF concludes takes the place of what was measured: true or false",
       &config.crf_write_back},
      {"cliques",
       "of pn-potts and hierarchical: cubes:SIZE [m], superpixel[:NUMBER] (of a frame) "
       "or supervoxel[:SEEDS' DISTANCE [m]]",
       &config.cliques},
      {"clique_leaves_out",
       "none, or classes with commas between: voxels that are likely one of them are "
       "in no "
       "clique",
       &config.clique_leaves_out},
      {"clique_leaves_out_above", "probability of these classes, in that",
       &config.clique_leaves_out_above}};
  for (ConfigParameter& parameter : parametersOf(config.clique_parameters))
    parameters.push_back(std::move(parameter));
  for (ConfigParameter& parameter : parametersOf(config.crf_parameters, "m"))
    parameters.push_back(std::move(parameter));
  parameters.push_back({"threads", "0 = all processors", &config.threads});
  return parameters;
}

void
readMapperConfig(const std::string& path, MapperConfig& config)
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

CRFModelType
MapperConfig::crfModel() const
{
  const auto model = std::find(crf_models.begin(), crf_models.end(), crf);
  return static_cast<CRFModelType>(model - crf_models.begin());
}

std::string
printMapperConfig(const MapperConfig& config)
{
  MapperConfig copy = config;
  return printParameters(parametersOf(copy));
}

} // namespace pcl_semantic
