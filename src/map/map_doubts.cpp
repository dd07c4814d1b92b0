// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/map_doubts.h>

#include "core/text_stream.h"

namespace pcl_semantic {

std::vector<std::string>
doubtsOf(const MapParameters& parameters)
{
  std::vector<std::string> doubts;
  const auto doubt = [&](const char* name, double value, double usual) {
    if (!(value > usual))
      return;
    TextStream text;
    text << name << " is " << value << " m, usual are at most " << usual
         << " m: is it in metres?";
    doubts.push_back(text.str());
  };
  doubt("voxel_size", parameters.voxel_size, 2.0);
  doubt("max_depth", parameters.max_range, 1000.0);
  return doubts;
}

} // namespace pcl_semantic
