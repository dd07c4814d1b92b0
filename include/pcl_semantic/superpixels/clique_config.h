// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Settings of cliques besides the number that their word has. */
struct CliqueParameters {
  SuperpixelParameters superpixel;
  SupervoxelParameters supervoxel;

  /** \throws InvalidParameterException */
  void validate() const;
};

/** \brief All of them. */
ConfigParameters parametersOf(CliqueParameters& parameters);

/** \brief Superpixels by name: `slic`, or `slic:NUMBER` for about so many.
 * \return false if \a text does not begin so
 * \throws InvalidParameterException at a number that cannot be */
bool parseSlic(const std::string& text, SlicParameters& parameters);

/** \brief Whether a text names a generator that needs the cloud alone: `cubes`, `slic`
 * or `supervoxel`, also with a number. */
bool namesCloudCliques(const std::string& text);

/** \brief The generator a text names: `cubes:SIZE`, the edge in metres;
 * `slic[:NUMBER]`, superpixels of an organized cloud; `superpixel[:NUMBER]`, those of a
 * frame in a map. \throws InvalidParameterException if there is none such */
CliqueGenerator::Ptr
makeCliqueGenerator(const std::string& text,
                    const CliqueParameters& parameters = CliqueParameters());

} // namespace pcl_semantic
