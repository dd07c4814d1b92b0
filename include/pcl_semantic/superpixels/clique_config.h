// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Settings of clique generators, besides the number in their name. */
struct CliqueParameters {
  SuperpixelParameters superpixel;
  SupervoxelParameters supervoxel;

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

ConfigParameters parametersOf(CliqueParameters& parameters);

/** \brief Parses `slic`, or `slic:NUMBER` for about NUMBER superpixels.
 * \return false if \a text is another generator
 * \throws InvalidParameterException for an invalid number */
bool parseSlic(const std::string& text, SlicParameters& parameters);

/** \brief Whether a text names a generator that needs only a cloud: `cubes`, `slic` or
 * `supervoxel`, optionally with a number. */
bool namesCloudCliques(const std::string& text);

/** \brief Makes a generator by name: `cubes:SIZE`, the edge in metres; `slic[:NUMBER]`,
 * superpixels of an organized cloud; `superpixel[:NUMBER]`, those of a frame in a map.
 * \throws InvalidParameterException for another name */
CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text,
                    const CliqueParameters& parameters = CliqueParameters());

} // namespace pcl_semantic
