/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "mapper_options.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic::tool {

namespace po = boost::program_options;

void
addParameters(MapperConfig& config, po::options_description& options)
{
  po::options_description parameters("Parameters (with their defaults)");
  for (const ConfigParameter& parameter : parametersOf(config))
    parameters.add_options()(parameter.option().c_str(),
                             po::value<std::string>()->value_name(parameter.text()),
                             parameter.help.c_str());
  options.add(parameters);
}

void
readParameters(const std::string& path, const po::variables_map& values,
               MapperConfig& config)
{
  if (!path.empty())
    readMapperConfig(path, config);
  for (ConfigParameter& parameter : parametersOf(config))
    if (values.count(parameter.option()))
      try {
        parameter.set(values[parameter.option()].as<std::string>(),
                      "--" + parameter.option());
      }
      catch (const BadInputException& error) {
        PCL_THROW_EXCEPTION(InvalidParameterException, error.what());
      }
  config.validate();
}

} // namespace pcl_semantic::tool
