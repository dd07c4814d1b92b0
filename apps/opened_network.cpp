// SPDX-License-Identifier: BSD-3-Clause
#include "opened_network.h"
#include "command_line.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <algorithm>
#include <optional>

namespace pcl_semantic::tool {

namespace {

std::optional<NetworkEngine>
engineOf(const std::string& name)
{
  if (name.empty())
    return networkEngines().front();
  if (name == "opencv")
    return NetworkEngine::opencv;
  if (name == "onnxruntime")
    return NetworkEngine::onnx_runtime;
  return std::nullopt;
}

} // namespace

const char* const engine_help =
    "what computes the network: onnxruntime or opencv (default: onnxruntime if this "
    "program was built with it)";

void
requireEngine(const std::string& name, const std::string& network)
{
  refuseIf(!name.empty() && network.empty(), "--engine needs --network");
  const std::optional<NetworkEngine> engine = engineOf(name);
  refuseIf(!engine, "--engine is '" + name + "', expected onnxruntime or opencv");
  const std::vector<NetworkEngine> engines = networkEngines();
  refuseIf(!std::count(engines.begin(), engines.end(), *engine),
           "--engine " + name + ": this program was built without it, expected opencv");
}

OpenedNetwork
openNetwork(const std::string& description, const std::string& model,
            const std::string& engine)
{
  const NetworkDescription network = readNetworkDescription(description);
  OpenedNetwork opened;
  opened.label_set = readLabelSet(network.label_set_path);
  opened.label_set_path = network.label_set_path;
  opened.model = model.empty() ? network.model_path : model;
  opened.predictor = std::make_unique<NetworkPredictor>(
      network, opened.label_set, model, engineOf(engine).value());
  return opened;
}

} // namespace pcl_semantic::tool
