// SPDX-License-Identifier: BSD-3-Clause
#include "opened_network.h"
#include "command_line.h"
#include "network_trial.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace pcl_semantic::tool {

namespace {

const std::pair<const char*, NetworkEngine> engine_names[] = {
    {"opencv", NetworkEngine::opencv}, {"onnxruntime", NetworkEngine::onnx_runtime}};

std::string
nameOf(NetworkEngine engine)
{
  return std::find_if(std::begin(engine_names), std::end(engine_names),
                      [&](const auto& named) { return named.second == engine; })
      ->first;
}

std::optional<NetworkEngine>
engineOf(const std::string& name)
{
  if (name.empty())
    return networkEngines().front();
  for (const auto& [each, engine] : engine_names)
    if (name == each)
      return engine;
  return std::nullopt;
}

} // namespace

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
  tryNetwork(description, model, engine);
  return loadNetwork(description, model, engine);
}

OpenedNetwork
loadNetwork(const std::string& description, const std::string& model,
            const std::string& engine)
{
  const NetworkDescription network = readNetworkDescription(description);
  OpenedNetwork opened;
  opened.label_set = readLabelSet(network.label_set_path);
  opened.label_set_path = network.label_set_path;
  opened.model = model.empty() ? network.model_path : model;
  const NetworkEngine used = engineOf(engine).value();
  opened.engine = nameOf(used);
  opened.predictor =
      std::make_unique<NetworkPredictor>(network, opened.label_set, model, used);
  return opened;
}

} // namespace pcl_semantic::tool
