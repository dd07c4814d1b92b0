// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/kitti11.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

/** \brief Writes small ONNX files, valid and invalid ones, byte by byte. */
namespace pcl_semantic {

/** \brief A protocol buffer message under construction. */
class Message {
public:
  Message&
  number(std::uint32_t field, std::uint64_t value)
  {
    varint(field << 3);
    varint(value);
    return *this;
  }

  Message&
  bytes(std::uint32_t field, const std::string& value)
  {
    varint(field << 3 | 2);
    varint(value.size());
    text_ += value;
    return *this;
  }

  Message&
  message(std::uint32_t field, const Message& value)
  {
    return bytes(field, value.text_);
  }

  const std::string&
  text() const
  {
    return text_;
  }

private:
  void
  varint(std::uint64_t value)
  {
    for (; value >= 0x80; value >>= 7)
      text_ += static_cast<char>(value | 0x80);
    text_ += static_cast<char>(value);
  }

  std::string text_;
};

/** \brief TensorProto of float32 with its elements as raw data. */
inline Message
floatTensor(const std::string& name, const std::vector<std::uint64_t>& dims,
            const std::vector<float>& values)
{
  Message tensor;
  for (const std::uint64_t dim : dims)
    tensor.number(1, dim);
  std::string raw(values.size() * sizeof(float), '\0');
  if (!values.empty())
    std::memcpy(&raw[0], values.data(), raw.size());
  return tensor.number(2, 1).bytes(8, name).bytes(9, raw);
}

/** \brief ValueInfoProto of a float32 tensor. */
inline Message
floatValue(const std::string& name, const std::vector<std::uint64_t>& dims)
{
  Message shape;
  for (const std::uint64_t dim : dims)
    shape.message(1, Message().number(1, dim));
  const Message tensor_type = Message().number(1, 1).message(2, shape);
  return Message().bytes(1, name).message(2, Message().message(1, tensor_type));
}

/** \brief ModelProto around a graph. */
inline std::string
onnxModel(const Message& graph)
{
  return Message()
      .number(1, 6)
      .message(8, Message().bytes(1, "").number(2, 11))
      .message(7, graph)
      .text();
}

/** \brief A 1 x 1 convolution: "image" (1 x 3 x height x width) -> "logits". */
struct PointwiseNetwork {
  int width = 8;
  int height = 6;
  int channels = 4;
  std::vector<float> weights; ///< channels x 3
  std::vector<float> bias;    ///< channels

  /** \brief The file with other tensors instead of weights and bias. */
  std::string
  withTensors(const Message& weight_tensor, const Message& bias_tensor) const
  {
    const Message kernel =
        Message().bytes(1, "kernel_shape").number(8, 1).number(8, 1).number(20, 7);
    const Message node = Message()
                             .bytes(1, "image")
                             .bytes(1, "weights")
                             .bytes(1, "bias")
                             .bytes(2, "logits")
                             .bytes(3, "classifier")
                             .bytes(4, "Conv")
                             .message(5, kernel);
    const std::uint64_t w = width, h = height, c = channels;
    return onnxModel(Message()
                         .message(1, node)
                         .bytes(2, "pointwise")
                         .message(5, weight_tensor)
                         .message(5, bias_tensor)
                         .message(11, floatValue("image", {1, 3, h, w}))
                         .message(12, floatValue("logits", {1, c, h, w})));
  }

  std::string
  file() const
  {
    const std::uint64_t c = channels;
    return withTensors(floatTensor("weights", {c, 3, 1, 1}, weights),
                       floatTensor("bias", {c}, bias));
  }
};

/** \brief The description of a PointwiseNetwork of the default size. */
inline std::string
smallNetworkYaml(const std::string& model, const std::string& channels)
{
  return "model: " + model + "\nlabel_set: " + kitti11 +
         "\ninput: {name: image, width: 8, height: 6}\n"
         "output: {name: logits, softmax: true}\nmean: [0.5, 0.5, 0.5]\n"
         "deviation: [0.2, 0.2, 0.2]\nchannels: [" +
         channels + "]\n";
}

/** \brief A network file with the size and channels described in data/networks. */
inline std::string
cityNetwork()
{
  PointwiseNetwork network;
  network.width = 1280;
  network.height = 480;
  network.channels = 20;
  network.weights.assign(60, 0.1f);
  network.bias.assign(20, 0.0f);
  network.bias[2] = 1.0f;
  return network.file();
}

} // namespace pcl_semantic
