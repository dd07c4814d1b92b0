// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Why a parameter of earlier versions is refused, as "had no effect, removed";
 * empty if there was none of that name. */
std::string whyRemoved(const std::string& name);

/** \brief Sets the parameters a YAML file names; the others keep their values.
 * \throws BadInputException with file and line, at a misspelt key for example */
void readParameters(const std::string& path, ConfigParameters parameters);

/** \brief The parameters as a YAML file that readParameters takes, without those of
 * presets that have their defaults. */
std::string printParameters(const ConfigParameters& parameters);

/** \brief Sets the parameters of a config that a YAML file names; the others keep their
 * values. \param[in] path empty = no file
 * \throws BadInputException with file and line */
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
