// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_options.h"

#include <pcl_semantic/core/exceptions.h>

namespace pcl_semantic::tool {

namespace po = boost::program_options;

void
addParameters(const ConfigParameters& parameters, po::options_description& options)
{
  po::options_description group("Parameters (with their defaults)");
  for (const ConfigParameter& parameter : parameters)
    // Further names are understood, but not shown.
    group.add_options()((parameter.option() + (parameter.old_name.empty() ? "" : ",") +
                         parameter.oldOption())
                            .c_str(),
                        po::value<std::string>()->value_name(parameter.text()),
                        parameter.help.c_str());
  options.add(group);
}

void
setParameters(const po::variables_map& values, ConfigParameters parameters)
{
  for (ConfigParameter& parameter : parameters)
    if (values.count(parameter.option()))
      try {
        parameter.set(values[parameter.option()].as<std::string>(),
                      "--" + parameter.option());
      }
      catch (const BadInputException& error) {
        PCL_THROW_EXCEPTION(InvalidParameterException, error.what());
      }
}

} // namespace pcl_semantic::tool
