// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A segmentation network that is ready to label images. */
struct OpenedNetwork {
  LabelSet label_set;
  std::string label_set_path; ///< as its description names it
  std::string model;          ///< path of the network itself (ONNX)
  std::string engine;         ///< "onnxruntime" or "opencv"
  std::unique_ptr<LabelPredictor> predictor;
};

/** \brief Help of an option that parseEngine() reads. */
constexpr const char* kEngineHelp =
    "what computes the network: onnxruntime or opencv (default: onnxruntime if this "
    "program was built with it)";

/** \brief The engine that a word names; the fastest one if it is empty.
 * \throws InvalidParameterException if there is none of that name in this build */
NetworkEngine parseEngine(const std::string& engine);

/** \brief Opens a network.
 * \param[in] description path (YAML)
 * \param[in] model path (ONNX); empty = the one that the description names
 * \param[in] engine as parseEngine() takes it
 * \throws BadInputException, BadModelException, InvalidParameterException as
 * readNetworkDescription() and NetworkPredictor */
OpenedNetwork openNetwork(const std::string& description, const std::string& model = "",
                          const std::string& engine = "");

} // namespace pcl_semantic
