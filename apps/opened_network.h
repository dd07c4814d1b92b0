// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/labelling/label_predictor.h>

#include <memory>
#include <string>

namespace pcl_semantic::tool {

/** \brief A segmentation network that is ready to label images. */
struct OpenedNetwork {
  LabelSet label_set;
  std::string label_set_path; ///< as its description names it
  std::string model;          ///< path of the network itself (ONNX)
  std::string engine;         ///< as --engine names it
  std::unique_ptr<LabelPredictor> predictor;
};

constexpr const char* engine_help =
    "what computes the network: onnxruntime or opencv (default: onnxruntime if this "
    "program was built with it)";

/** \brief failUsage() if --engine names none that there is, or comes without --network.
 * \param[in] engine empty = the fastest */
void requireEngine(const std::string& engine, const std::string& network);

/** \brief Opens the network of --network, --model and --engine, after tryNetwork().
 * \param[in] description path (YAML)
 * \param[in] model path (ONNX); empty = the one the description names
 * \param[in] engine as requireEngine() takes it
 * \throws BadInputException, BadModelException, InvalidParameterException as
 * readNetworkDescription() and NetworkPredictor */
OpenedNetwork openNetwork(const std::string& description, const std::string& model,
                          const std::string& engine);

/** \brief The same without the trial. */
OpenedNetwork loadNetwork(const std::string& description, const std::string& model,
                          const std::string& engine);

} // namespace pcl_semantic::tool
