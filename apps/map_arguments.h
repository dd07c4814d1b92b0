// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sequence_options.h"

#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/pipeline/mapping_archive.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief The programs whose command line it is. */
enum class MapProgram { map, live };

/** \brief The command line of pcl_semantic_map, or of pcl_semantic_live. */
struct MapArguments {
  SequenceOptions sequence;
  std::string clouds;        ///< instead of the sequence: folder or pattern of .pcd
  std::string rgbd;          ///< likewise: folder of an RGB-D sequence
  double depth_scale = 0.0;  ///< of its depth images; 0 = as their layout has it
  std::string sensor;        ///< of the clouds, see CloudSource
  std::string label_mapping; ///< of their labels; empty = they are labels
  bool states_confidence = false; ///< --label-confidence is given
  std::string scan_columns;       ///< of `.bin` scans; empty = see readCloudTable()
  std::string output, labels, label_set, network, model, engine, config;
  std::string poses = "auto";
  std::string label_calibration, clique_calibration;
  std::string frames = ":";
  std::string also; ///< measured, depth, probabilities, scans: see makeExtras()
  double scan_within = 0.0;
  bool map_only = false; ///< no images of the frames
  bool centres = false;  ///< the map's points are the centres of its voxels
  bool print_config = false;
  bool view = false;         ///< a window, see openLiveView()
  bool live = false;         ///< frames as they come, see mapLive()
  bool every_frame = false;  ///< of pcl_semantic_live: those of two videos
  bool archive_only = false; ///< nothing is written to `output`
  std::string submap_every;  ///< "50m" or "100"; empty = one map, see submapsOf()
  MappingArchive::Options archive;
  MapperConfig parameters;
};

/** \brief Reads it.
 * \throws InvalidParameterException, BadInputException, Exit as parseCommandLine() */
MapArguments parseMapArguments(int argc, char** argv, MapProgram program);

/** \brief Checks for missing and contradicting options.
 * \throws InvalidParameterException */
void requireMapArguments(const MapArguments& arguments);

} // namespace pcl_semantic::tool
