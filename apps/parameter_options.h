// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/pipeline/mapper_config.h>

#include <boost/program_options.hpp>

#include <string>

namespace pcl_semantic::tool {

/** \brief Adds an option for each parameter, its value as the default. */
void addParameters(const ConfigParameters& parameters,
                   boost::program_options::options_description& options);

/** \brief Sets the parameters whose options were given.
 * \throws InvalidParameterException if a value cannot be read */
void setParameters(const boost::program_options::variables_map& values,
                   ConfigParameters parameters);

} // namespace pcl_semantic::tool
