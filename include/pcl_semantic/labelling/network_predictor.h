// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/labelling/logits_to_distributions.h>
#include <pcl_semantic/labelling/network_description.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Runs a segmentation network (ONNX) on the left image by OpenCV's dnn module,
 * on the CPU.
 *
 * The image is resized bilinearly to the network's input; its output becomes class
 * distributions as distributionsFromLogits() says. Grey images are taken as colour
 * images with three equal channels. Not for use from several threads at once. */
class NetworkPredictor : public LabelPredictor {
public:
  /** \param[in] description of the network
   * \param[in] label_set the classes of the distributions
   * \param[in] model_path the ONNX file; empty = the one the description names
   * \throws InvalidParameterException if a channel's class is not in \a label_set
   * \throws BadInputException if the file cannot be read
   * \throws BadModelException if it is no network that OpenCV can load */
  NetworkPredictor(const NetworkDescription& description, const LabelSet& label_set,
                   const std::string& model_path = "");
  ~NetworkPredictor() override;

  /** \throws BadInputException if the image is not 8-bit grey or colour
   * \throws BadModelException that names the frame, if the network fails or its output
   * is not 1 x channels x height x width, finite */
  LabelDistributions predict(const StereoFrame& frame) override;

private:
  struct Network;

  NetworkDescription description_;
  ChannelClasses channels_;
  std::unique_ptr<Network> network_;
};

} // namespace pcl_semantic
