// SPDX-License-Identifier: BSD-3-Clause
#include "opened_network.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>

namespace pcl_semantic::tool {

OpenedNetwork
openNetwork(const std::string& description, const std::string& model)
{
  const NetworkDescription network = readNetworkDescription(description);
  OpenedNetwork opened;
  opened.label_set = readLabelSet(network.label_set_path);
  opened.label_set_path = network.label_set_path;
  opened.model = model.empty() ? network.model_path : model;
  opened.predictor =
      std::make_unique<NetworkPredictor>(network, opened.label_set, model);
  return opened;
}

} // namespace pcl_semantic::tool
