/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/pipeline/mapper_config.h>

#include <boost/program_options.hpp>

#include <string>

namespace pcl_semantic::tool {

/** \brief Adds an option for each parameter of \a config, its value as the default. */
void addParameters(MapperConfig& config,
                   boost::program_options::options_description& options);

/** \brief Sets parameters from a YAML file, then from the options that were given.
 * \param[in] path empty = no file
 * \throws BadInputException for the file, InvalidParameterException for options */
void readParameters(const std::string& path,
                    const boost::program_options::variables_map& values,
                    MapperConfig& config);

} // namespace pcl_semantic::tool
