// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/network_predictor.h>

#include "core/fail.h"
#include "files/yaml_config.h"
#include "images/opencv_settings.h"
#include "onnx_interface.h"
#include "onnx_runtime_runner.h"
#include "opencv_runner.h"

#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr int max_input_size = 8192;

std::string
pathBeside(const std::string& yaml_path, const std::string& path)
{
  return (std::filesystem::path(yaml_path).parent_path() / path)
      .lexically_normal()
      .string();
}

int
readSize(const YamlMap& input, const char* key)
{
  const int size = input.require<int>(key);
  if (size < 1 || size > max_input_size)
    fail<BadInputException>(input.where(key), ": ", key, " is ", size,
                            ", expected 1 to ", max_input_size);
  return size;
}

std::array<float, 3>
readColour(const YamlMap& file, const char* key)
{
  const auto values = file.require<std::vector<double>>(key);
  if (values.size() != 3)
    fail<BadInputException>(file.where(key), ": expected [red, green, blue]");
  std::array<float, 3> colour{};
  for (int i = 0; i < 3; ++i) {
    colour[i] = static_cast<float>(values[i]);
    if (!std::isfinite(colour[i]))
      fail<BadInputException>(file.where(key), ": ", key, " is not finite");
  }
  return colour;
}

void
checkChannels(const YamlMap& file, const NetworkDescription& description)
{
  const LabelSet label_set = readLabelSet(description.label_set_path);
  if (description.channels.empty())
    fail<BadInputException>(file.where("channels"), ": the list is empty");
  for (std::size_t i = 0; i < description.channels.size(); ++i) {
    const std::string& name = description.channels[i];
    if (name != "-" && label_set.find(name) == kUnlabelled)
      fail<BadInputException>(file.where("channels"), ": channel ", i, ": class '",
                              name, "' is not in ", description.label_set_path);
  }
}

} // namespace

NetworkDescription
readNetworkDescription(const std::string& yaml_path)
{
  const YamlMap file = YamlMap::load(yaml_path);
  NetworkDescription description;
  std::string model;
  if (file.get("model", model))
    description.model_path = pathBeside(yaml_path, model);
  description.label_set_path =
      pathBeside(yaml_path, file.require<std::string>("label_set"));

  const YamlMap input = file.requireMap("input");
  description.input_name = input.require<std::string>("name");
  description.input_width = readSize(input, "width");
  description.input_height = readSize(input, "height");
  input.refuseUnknownKeys();

  const YamlMap output = file.requireMap("output");
  description.output_name = output.require<std::string>("name");
  output.get("softmax", description.softmax);
  output.refuseUnknownKeys();

  description.mean = readColour(file, "mean");
  description.deviation = readColour(file, "deviation");
  for (const float deviation : description.deviation)
    if (deviation <= 0.0f)
      fail<BadInputException>(file.where("deviation"), ": expected more than 0, not ",
                              deviation);
  description.channels = file.require<std::vector<std::string>>("channels");
  file.refuseUnknownKeys();
  checkChannels(file, description);
  return description;
}

std::vector<NetworkEngine>
networkEngines()
{
#ifdef PCL_SEMANTIC_ONNX_RUNTIME
  return {NetworkEngine::onnx_runtime, NetworkEngine::opencv};
#else
  return {NetworkEngine::opencv};
#endif
}

namespace {

const char*
nameOf(NetworkEngine engine)
{
  return engine == NetworkEngine::opencv ? "OpenCV" : "ONNX Runtime";
}

std::unique_ptr<NetworkRunner>
makeRunner(NetworkEngine engine, std::vector<std::uint8_t> bytes,
           const NetworkDescription& network)
{
  if (engine == NetworkEngine::opencv)
    return runWithOpenCv(std::move(bytes), network.input_name, network.output_name);
#ifdef PCL_SEMANTIC_ONNX_RUNTIME
  return runWithOnnxRuntime(bytes, network.input_name, network.output_name);
#else
  return nullptr; // unreachable: the constructor refuses it
#endif
}

std::string
joined(const std::vector<std::string>& names)
{
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 8; ++i)
    text += (i ? ", " : "") + inQuotes(names[i]);
  return text.empty() ? "none" : text;
}

// Requires the names of the description in the network.
void
requireNames(const OnnxInterface& network, const NetworkDescription& description,
             NetworkEngine engine, const std::string& path)
{
  std::vector<std::string> inputs;
  for (const OnnxInterface::Input& input : network.inputs)
    inputs.push_back(input.name);
  const auto require = [&](const std::string& name, const char* kind, const auto& all,
                           const auto& shown) {
    if (!std::count(all.begin(), all.end(), name))
      fail<BadModelException>(path, ": has no ", kind, " ", inQuotes(name),
                              ", which its description names; its ", kind, "s are ",
                              joined(shown));
  };
  require(description.input_name, "input", inputs, inputs);
  // OpenCV can also return inner tensors.
  require(description.output_name, "output",
          engine == NetworkEngine::opencv ? network.inner : network.outputs,
          network.outputs);
}

// Hint for networks run at another size than their export size, a likely cause of
// failure. Empty if the size is the description's.
std::string
otherSize(const OnnxInterface& network, const NetworkDescription& description)
{
  for (const OnnxInterface::Input& input : network.inputs) {
    if (input.name != description.input_name || input.size.size() != 4 ||
        input.size[2] <= 0 || input.size[3] <= 0 ||
        (input.size[2] == description.input_height &&
         input.size[3] == description.input_width))
      continue;
    return " (it was exported for images of " + std::to_string(input.size[3]) + " x " +
           std::to_string(input.size[2]) + ", its description says " +
           std::to_string(description.input_width) + " x " +
           std::to_string(description.input_height) + ")";
  }
  return "";
}

/** \brief Returns the result of \a body. Converts exceptions of the engine and its
 * libraries (for example Protocol Buffers) to EngineError or std::bad_alloc. */
template <typename Body>
auto
withOpenCv(Body&& body)
{
  try {
    const QuietOpenCv quiet;
    return body();
  }
  catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem)
      throw std::bad_alloc();
    throw EngineError(error.err);
  }
  catch (const std::bad_alloc&) {
    throw;
  }
  catch (const std::exception& error) { // std::length_error of an invalid size
    throw EngineError(error.what());
  }
}

// N x 3 x H x W: (RGB / 255 - mean) / deviation.
cv::Mat
makeInput(const cv::Mat& image, const NetworkDescription& description)
{
  const cv::Size size(description.input_width, description.input_height);
  cv::Mat resized;
  cv::resize(image, resized, size, 0.0, 0.0, cv::INTER_LINEAR);
  const int shape[] = {1, 3, size.height, size.width};
  cv::Mat input(4, shape, CV_32FC1);
  for (int channel = 0; channel < 3; ++channel) {
    cv::Mat plane(size, CV_32FC1, input.ptr<float>(0, channel)), values = resized;
    if (resized.channels() == 3)
      cv::extractChannel(resized, values, 2 - channel);
    const double deviation = description.deviation[channel];
    values.convertTo(plane, CV_32FC1, 1.0 / (255.0 * deviation),
                     -description.mean[channel] / deviation);
  }
  return input;
}

// Reshapes the output to channels x height x width.
cv::Mat
checkOutput(const cv::Mat& output, const NetworkDescription& description, int frame)
{
  const int channels = static_cast<int>(description.channels.size());
  const std::string subject = "frame " + std::to_string(frame) + ": output '" +
                              description.output_name + "' of the network ";
  if (output.dims != 4 || output.type() != CV_32FC1 || output.empty() ||
      output.size[0] != 1 || !output.isContinuous())
    fail<BadModelException>(subject, "has ", output.dims,
                            " axes, expected 1 x channels x height x width");
  if (output.size[1] != channels)
    fail<BadModelException>(subject, "has ", output.size[1],
                            " channels, its description names ", channels);
  const int shape[] = {channels, output.size[2], output.size[3]};
  return output.reshape(1, 3, shape);
}

} // namespace

struct NetworkPredictor::Network {
  std::string path;
  std::string other_size; // for a message, see otherSize()
  std::unique_ptr<NetworkRunner> runner;
};

NetworkPredictor::NetworkPredictor(const NetworkDescription& description,
                                   const LabelSet& label_set,
                                   const std::string& model_path, NetworkEngine engine)
    : description_(description), network_(std::make_unique<Network>())
{
  const std::vector<NetworkEngine> engines = networkEngines();
  if (!std::count(engines.begin(), engines.end(), engine))
    fail<InvalidParameterException>("this library was built without ", nameOf(engine));
  channels_.classes = label_set.size();
  channels_.softmax = description.softmax;
  for (const std::string& name : description.channels) {
    channels_.labels.push_back(name == "-" ? kUnlabelled : label_set.find(name));
    if (name != "-" && channels_.labels.back() == kUnlabelled)
      fail<InvalidParameterException>("class '", name,
                                      "' of the network is not in the label set");
  }
  network_->path = model_path.empty() ? description.model_path : model_path;
  if (network_->path.empty())
    fail<InvalidParameterException>(
        "the description of the network names no model: give one");
  load(engine);
}

NetworkPredictor::~NetworkPredictor() = default;

void
NetworkPredictor::load(NetworkEngine engine)
{
  const std::string& path = network_->path;
  std::vector<std::uint8_t> bytes = readBytes(path);
  const OnnxInterface interface = readOnnxInterface(bytes, path);
  requireNames(interface, description_, engine, path);
  network_->other_size = otherSize(interface, description_);
  try {
    network_->runner =
        withOpenCv([&] { return makeRunner(engine, std::move(bytes), description_); });
  }
  catch (const EngineError& error) {
    fail<BadModelException>(path, ": ", nameOf(engine),
                            " cannot load the network: ", error.what());
  }
}

LabelDistributions
NetworkPredictor::predict(const cv::Mat& image, int frame)
{
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_8UC3))
    fail<BadInputException>("frame ", frame,
                            ": image: expected 8-bit grey or 8-bit colour");
  cv::Mat output;
  try {
    output = withOpenCv(
        [&] { return network_->runner->run(makeInput(image, description_)); });
  }
  catch (const EngineError& error) {
    fail<BadModelException>("frame ", frame, ": ", network_->path,
                            ": the network fails: ", error.what(),
                            network_->other_size);
  }
  const cv::Mat logits = checkOutput(output, description_, frame);
  try {
    return distributionsFromLogits(logits, image.size(), channels_);
  }
  catch (const BadInputException& error) {
    fail<BadModelException>("frame ", frame, ": output '", description_.output_name,
                            "' of the network ", error.what());
  }
}

} // namespace pcl_semantic
