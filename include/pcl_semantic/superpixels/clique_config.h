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

/** \brief Whether a text names a generator, alone or with others: `planes,slic:100` has
 * the words `planes` and `slic`. */
bool namesCliques(const std::string& text, const std::string& word);

/** \brief Parses `slic`, or `slic:NUMBER` for about NUMBER superpixels.
 * \return false if \a text is another generator
 * \throws InvalidParameterException for an invalid number */
bool parseSlic(const std::string& text, SlicParameters& parameters);

/** \brief Whether a text names generators that need only a cloud: all but
 * `superpixel`. */
bool namesCloudCliques(const std::string& text);

/** \brief Makes a generator by name: `cubes[:EDGE]` and `planes[:EDGE]` with an edge in
 * metres; `supervoxel[:DISTANCE]`; `slic[:NUMBER]`, superpixels of an organized cloud;
 * `superpixel[:NUMBER]`, those of a frame in a map. Several, separated by commas, give
 * RankedCliques.
 * \throws InvalidParameterException for another name */
CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text,
                    const CliqueParameters& parameters = CliqueParameters());

} // namespace pcl_semantic
