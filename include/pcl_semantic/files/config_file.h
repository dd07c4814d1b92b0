// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reason why a parameter of an earlier version is refused, such as "had no
 * effect, removed"; empty if there was no such parameter. */
std::string whyRemoved(const std::string& name);

/** \brief Sets the parameters in a YAML file; the others keep their values.
 * \throws BadInputException with file and line, for example for a misspelt key */
void readParameters(const std::string& path, ConfigParameters parameters);

/** \brief Formats parameters as a YAML file for readParameters(), without preset
 * parameters at their defaults. */
std::string printParameters(const ConfigParameters& parameters);

/** \brief Sets the parameters of a config from a YAML file; the others keep their
 * values.
 * \param[in] path empty = no file
 * \throws BadInputException that names file and line, if a key or value is invalid */
template <typename Config>
void
readConfig(const std::string& path, Config& config)
{
  if (path.empty())
    return;
  readParameters(path, parametersOf(config));
  try {
    config.validate();
  }
  catch (const InvalidParameterException& error) {
    throw BadInputException(path + ": " + error.what());
  }
}

} // namespace pcl_semantic
