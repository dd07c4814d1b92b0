// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/opened_network.h>

#include "core/fail.h"

#include <pcl_semantic/files/label_set_file.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

const std::pair<const char*, NetworkEngine> engine_names[] = {
    {"opencv", NetworkEngine::opencv}, {"onnxruntime", NetworkEngine::onnx_runtime}};

} // namespace

NetworkEngine
parseEngine(const std::string& engine)
{
  const std::vector<NetworkEngine> engines = networkEngines();
  if (engine.empty())
    return engines.front();
  const auto named =
      std::find_if(std::begin(engine_names), std::end(engine_names),
                   [&](const auto& each) { return each.first == engine; });
  if (named == std::end(engine_names))
    badParameter("--engine is '", engine, "', expected onnxruntime or opencv");
  if (!std::count(engines.begin(), engines.end(), named->second))
    badParameter("--engine ", engine,
                 ": this program was built without it, expected "
                 "opencv");
  return named->second;
}

void
requireEngine(const std::string& engine, const std::string& network)
{
  if (!engine.empty() && network.empty())
    badParameter("--engine needs --network");
  parseEngine(engine);
}

OpenedNetwork
openNetwork(const std::string& description, const std::string& model,
            const std::string& engine)
{
  const NetworkDescription network = readNetworkDescription(description);
  const NetworkEngine used = parseEngine(engine);
  OpenedNetwork opened;
  opened.label_set = readLabelSet(network.label_set_path);
  opened.label_set_path = network.label_set_path;
  opened.model = model.empty() ? network.model_path : model;
  opened.engine = std::find_if(std::begin(engine_names), std::end(engine_names),
                               [&](const auto& each) { return each.second == used; })
                      ->first;
  opened.predictor =
      std::make_unique<NetworkPredictor>(network, opened.label_set, model, used);
  return opened;
}

} // namespace pcl_semantic
