// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/labelling/logits_to_distributions.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Description of a segmentation network (`data/networks`). */
struct NetworkDescription {
  std::string model_path;      ///< ONNX file; empty if the description names none
  std::string label_set_path;  ///< label set of the classes in \a channels
  std::string input_name;      ///< N x 3 x H x W: (RGB / 255 - mean) / deviation
  int input_width = 0;         ///< [px]
  int input_height = 0;        ///< [px]
  std::string output_name;     ///< N x channels x any H x any W
  bool softmax = true;         ///< the output is logits; else probabilities
  std::array<float, 3> mean{}; ///< red, green, blue
  std::array<float, 3> deviation{{1.0f, 1.0f, 1.0f}}; ///< red, green, blue
  std::vector<std::string> channels; ///< class of each output channel; "-" = none
};

/** \brief Reads a description; its paths are relative to its own folder.
 * \throws BadInputException with file and line, also if its label set lacks a class */
NetworkDescription readNetworkDescription(const std::string& yaml_path);

/** \brief The engine that runs a network on the CPU. */
enum class NetworkEngine {
  opencv,      ///< OpenCV's dnn module
  onnx_runtime ///< ONNX Runtime, if the library was built with it
};

/** \brief The available engines, fastest first. */
std::vector<NetworkEngine> networkEngines();

/** \brief Runs a segmentation network (ONNX) on the left image.
 *
 * The image is resized bilinearly to the network's input. distributionsFromLogits()
 * converts the output to class distributions. Grey images become colour images with
 * three equal channels. One instance must not be used by several threads at once.
 *
 * OpenCV 4.6 ends the program at some damaged networks. Load unknown networks with
 * pcl_semantic_label first, which tries them in a separate process. */
class NetworkPredictor : public LabelPredictor {
public:
  /** \param[in] description of the network
   * \param[in] label_set the classes of the distributions
   * \param[in] model_path the ONNX file; empty = the file in the description
   * \param[in] engine ONNX Runtime uses the number of threads set at this moment
   * \throws InvalidParameterException if a channel's class is not in \a label_set, or
   * the engine not in networkEngines()
   * \throws BadInputException if the file cannot be read
   * \throws BadModelException if the engine cannot load the network */
  NetworkPredictor(const NetworkDescription& description, const LabelSet& label_set,
                   const std::string& model_path = "",
                   NetworkEngine engine = networkEngines().front());
  ~NetworkPredictor() override;

  /** \throws BadInputException if the image is not 8-bit grey or colour
   * \throws BadModelException that names the frame, if the network fails or its output
   * is not 1 x channels x height x width, finite */
  LabelDistributions predict(const cv::Mat& image, int frame) override;

private:
  struct Network;

  void load(NetworkEngine engine);

  NetworkDescription description_;
  ChannelClasses channels_;
  std::unique_ptr<Network> network_;
};

} // namespace pcl_semantic
