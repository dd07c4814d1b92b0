// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/mapper_config.h>

#include "core/config_checks.h"
#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/config_file.h>
#include <pcl_semantic/stereo/disparity_engines.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

const std::vector<std::string> crf_models = {"none", "dense", "pn-potts",
                                             "hierarchical"};

} // namespace

void
MapperConfig::validate()
{
  clique_parameters.supervoxel.voxel_resolution = map.voxel_size;
  clique_parameters.supervoxel.fixed_cubes = true;
  if (namesCliques(cliques, "slic")) // needs organized clouds
    badParameter("cliques are '", cliques,
                 "', expected planes, superpixel, supervoxel or cubes");
  makeCliqueGenerator(cliques, clique_parameters);
  map.validate();
  crf_parameters.validate();
  objects.validate();
  makeDisparityEstimator(stereo, disparities); // checks both
  for (const auto& [name, value] : {std::pair("max_deviation", max_deviation),
                                    std::pair("deviation_scale", deviation_scale)})
    require(value >= 0.0 && value <= 100.0, name, value, "0 to 100");
  require(min_hit_ratio >= 0.0 && min_hit_ratio <= 1.0, "min_hit_ratio", min_hit_ratio,
          "0 to 1");
  require(network_every >= 1, "network_every", network_every, "1 or more");
  require(crf_every >= 1, "crf_every", crf_every, "1 or more");
  requireConfidence(label_confidence);
}

const std::string&
nameOf(CRFModelType model)
{
  return crf_models.at(std::size_t(model));
}

ConfigParameters
parametersOf(MapperConfig& config)
{
  FusionParameters& fusion = config.map.fusion;
  ConfigParameters parameters = {
      {"stereo", "stereo engine: " + joinWords(disparityEngines()), &config.stereo},
      {"disparities",
       "range of the disparity search, a multiple of 64 (elas, sgbm: 16) [px]",
       &config.disparities},
      {"max_deviation", "maximum standard deviation of a disparity [px]; 0 = keep all",
       &config.max_deviation},
      {"deviation_scale",
       "scale of depth deviations; a ray clears no space within two scaled standard "
       "deviations of its depth; 0 = clear up to the depth",
       &config.deviation_scale},
      {"min_hit_ratio",
       "minimum fraction of hits among the pixels that hit a voxel or see through it, "
       "against foreground fattening; 0 = off",
       &config.min_hit_ratio},
      {"label_confidence", "probability of the class in a .png of --labels",
       &config.label_confidence},
      {"network_every",
       "use the labels of the first frame and of every N-th after it; other frames add "
       "only depth and colour",
       &config.network_every},
      {"voxel_size", "edge of a voxel [m]", &config.map.voxel_size},
      {"window",
       "extent X,Y,Z of the window around the sensor, along the world axes [m]; 0,0,0 "
       "= max_depth + 2 m in each direction, at most 24 m high; for recorded RGB-D as "
       "far as its depths need",
       &config.map.window},
      {"max_depth", "maximum depth of a hit [m]; pixels beyond it only clear space",
       &config.map.max_range},
      {"hit_probability", "occupancy probability of a voxel, given a hit",
       &fusion.hit_probability},
      {"miss_probability", "occupancy probability of a voxel, given a miss",
       &fusion.miss_probability},
      {"min_probability", "lower bound of the occupancy probability",
       &fusion.min_probability, "0.03"},
      {"max_probability", "upper bound of the occupancy probability",
       &fusion.max_probability, "0.97"},
      {"occupied_probability", "minimum occupancy probability of an occupied voxel",
       &fusion.occupied_probability, "0.5"},
      {"clearing",
       "part of a ray that clears space: none, full, or careful = without its end, "
       "where it may graze the surface that it hits",
       chooseFrom(fusion.clearing, {"none", "full", "careful"})},
      {"per_ray_counting",
       "count every ray instead of one hit or miss per frame, as in the paper: true or "
       "false",
       &fusion.per_ray_counting, "false"},
      {"free_dynamic",
       "free the voxels of dynamic classes that scans see past: true or false",
       &fusion.free_dynamic, "true"},
      {"pixel_fusion", "fusion of the pixels of a frame in one voxel: mean or product",
       chooseFrom(fusion.pixel_fusion, {"mean", "product"})},
      {"label_min_probability", "lower bound of each measured class probability",
       &fusion.label_min_probability, "0.01"},
      {"weigh_labels",
       "weigh the labels of a stereo frame by the precision of their depths: true or "
       "false",
       &fusion.weigh_labels, "true"},
      {"label_max_ratio",
       "upper bound of largest / smallest probability of a fused distribution",
       &fusion.label_max_ratio, "10000"},
      {"crf", "CRF model: " + joinWords(crf_models),
       chooseFrom(config.crf, crf_models)},
      {"crf_every", "run the CRF at the first frame and every N-th after it",
       &config.crf_every},
      {"crf_write_back",
       "replace the measured distributions by those of the CRF: true or false",
       &config.crf_write_back, "false"},
      {"cliques",
       "cliques of pn-potts and hierarchical: planes[:EDGE [m]], superpixel[:NUMBER] "
       "(number per frame), supervoxel[:SEED_DISTANCE [m]], cubes[:EDGE [m]], or "
       "several, separated by commas, the first with priority",
       &config.cliques}};
  append(parameters, parametersOf(config.clique_parameters));
  append(parameters, parametersOf(config.crf_parameters, "m"));
  parameters.push_back({"things",
                        "track the objects of the classes marked thing, see "
                        "doc/things.md: true or false",
                        &config.things, "true"});
  parameters.push_back(
      {"object_gap",
       "maximum distance between neighbouring voxels of an object [m], "
       "for classes without a gap in the label set",
       &config.objects.gap});
  parameters.push_back({"object_min_voxels", "minimum number of voxels of an object",
                        &config.objects.min_voxels});
  parameters.push_back(
      {"threads", "number of threads; 0 = all processors", &config.threads});
  return parameters;
}

std::vector<Label>
listedLabels(const std::string& names, const LabelSet& label_set,
             const std::string& what)
{
  std::vector<Label> labels;
  if (names == "none")
    return labels;
  for (const std::string_view name : splitAt(',', names)) {
    labels.push_back(label_set.find(std::string(name)));
    if (labels.back() == kUnlabelled)
      badParameter(what, ": class '", name, "' is not in the label set");
  }
  return labels;
}

void
readMapperConfig(const std::string& path, MapperConfig& config)
{
  readConfig(path, config);
}

std::string
printMapperConfig(const MapperConfig& config)
{
  MapperConfig copy = config;
  return printParameters(parametersOf(copy));
}

} // namespace pcl_semantic
