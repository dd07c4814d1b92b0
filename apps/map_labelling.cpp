// SPDX-License-Identifier: BSD-3-Clause
#include "map_labelling.h"
#include "opened_network.h"
#include "tool.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/stored_predictor.h>

#include <utility>

namespace pcl_semantic::tool {

MapLabelling
makeLabelling(const MapArguments& arguments)
{
  if (!arguments.network.empty()) {
    OpenedNetwork network =
        openNetwork(arguments.network, arguments.model, arguments.engine);
    return {network.label_set, std::move(network.predictor), network.model,
            network.engine, MappingWatch()};
  }
  const LabelSet label_set = readLabelSetOrDefault(arguments.label_set);
  PixelMapping mapping = readPixelMapping(arguments.label_mapping, label_set);
  MappingWatch watch(arguments.label_mapping, mapping, "pixels");
  return {label_set,
          std::make_unique<StoredPredictor>(
              arguments.labels, label_set.size(),
              float(arguments.parameters.label_confidence), std::move(mapping)),
          "", "", std::move(watch)};
}

} // namespace pcl_semantic::tool
