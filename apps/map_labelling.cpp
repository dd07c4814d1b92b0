// SPDX-License-Identifier: BSD-3-Clause
#include "map_labelling.h"
#include "default_label_set.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/labelling/stored_predictor.h>

namespace pcl_semantic::tool {

Labelling
makeLabelling(const MapArguments& arguments)
{
  if (!arguments.network.empty()) {
    const NetworkDescription network = readNetworkDescription(arguments.network);
    const LabelSet label_set = readLabelSet(network.label_set_path);
    return {label_set,
            std::make_unique<NetworkPredictor>(network, label_set, arguments.model),
            arguments.model.empty() ? network.model_path : arguments.model};
  }
  const LabelSet label_set = readLabelSetOrDefault(arguments.label_set);
  return {
      label_set,
      std::make_unique<StoredPredictor>(arguments.labels, label_set.size(),
                                        float(arguments.parameters.label_confidence)),
      ""};
}

Calibrations
readCalibrations(const MapArguments& arguments, const LabelSet& label_set)
{
  Calibrations calibrations;
  if (!arguments.label_calibration.empty())
    calibrations.labels = readCalibration(arguments.label_calibration, label_set);
  if (!arguments.clique_calibration.empty())
    calibrations.cliques =
        readCalibration(arguments.clique_calibration, label_set, "cliques");
  return calibrations;
}

void
setCalibrations(const Calibrations& calibrations, SemanticMapper& mapper)
{
  if (calibrations.labels)
    mapper.setLabelCalibration(*calibrations.labels);
  if (calibrations.cliques)
    mapper.setCliqueCalibration(*calibrations.cliques);
}

} // namespace pcl_semantic::tool
