// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A loaded segmentation network. */
struct OpenedNetwork {
  LabelSet label_set;
  std::string label_set_path; ///< from its description
  std::string model;          ///< path of the network (ONNX)
  std::string engine;         ///< "onnxruntime" or "opencv"
  std::unique_ptr<LabelPredictor> predictor;
};

/** \brief Help of an option that parseEngine() reads. */
constexpr const char* kEngineHelp =
    "inference engine of the network: onnxruntime or opencv (default: onnxruntime if "
    "this program was built with it)";

/** \brief Parses an engine's name; empty = the fastest engine.
 * \throws InvalidParameterException if this build has no such engine */
NetworkEngine parseEngine(const std::string& engine);

/** \brief Checks an engine by its name, as options have it.
 * \throws InvalidParameterException as parseEngine(), or without a network */
void requireEngine(const std::string& engine, const std::string& network);

/** \brief Opens a network.
 * \param[in] description path (YAML)
 * \param[in] model path (ONNX); empty = the one in the description
 * \param[in] engine as for parseEngine()
 * \throws BadInputException, BadModelException, InvalidParameterException as
 * readNetworkDescription() and NetworkPredictor */
OpenedNetwork openNetwork(const std::string& description, const std::string& model = "",
                          const std::string& engine = "");

} // namespace pcl_semantic
