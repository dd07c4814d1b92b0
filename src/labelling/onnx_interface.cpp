// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_interface.h"
#include "core/fail.h"

#include <algorithm>
#include <set>
#include <string_view>

namespace pcl_semantic {

namespace {

// A field of a protocol buffer message.
struct Field {
  enum Type { varint = 0, fixed64 = 1, bytes = 2, fixed32 = 5 };

  std::uint32_t number = 0;
  Type type = varint;
  std::uint64_t value = 0; // of a varint
  std::string_view data;   // of the other types
};

// Field numbers of onnx.proto.
namespace model_field {
constexpr std::uint32_t graph = 7;
}
namespace graph_field {
constexpr std::uint32_t node = 1, initializer = 5, input = 11, output = 12;
}
namespace node_field {
constexpr std::uint32_t output = 2;
}
namespace tensor_field {
constexpr std::uint32_t name = 8, external_data = 13;
}
namespace value_field { // and of the messages within its type
constexpr std::uint32_t name = 1, type = 2, tensor = 1, shape = 2, dimension = 1,
                        value = 1;
}

class OnnxReader {
public:
  explicit OnnxReader(const std::string& path) : path_(path) {}

  OnnxInterface
  readModel(std::string_view model) const
  {
    OnnxInterface interface;
    int graphs = 0;
    for (Field field; next(model, field);)
      if (field.number == model_field::graph) {
        interface = readGraph(messageOf(field));
        ++graphs;
      }
    if (graphs != 1)
      fail<BadModelException>(path_, ": is no ONNX file: it has ", graphs,
                              " graphs, expected 1");
    return interface;
  }

private:
  template <typename... Parts>
  [[noreturn]] void
  refuse(const Parts&... why) const
  {
    fail<BadModelException>(path_, ": is no ONNX file, or damaged: ", why...);
  }

  // A number at the beginning of the bytes, which it is cut off from.
  std::uint64_t
  readVarint(std::string_view& bytes) const
  {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
      const std::uint64_t byte = static_cast<std::uint8_t>(bytes.front());
      bytes.remove_prefix(1);
      if (shift == 63 && byte > 1)
        break;
      value |= (byte & 0x7F) << shift;
      if (byte < 0x80)
        return value;
    }
    refuse("a number is cut off");
  }

  // The same with a field of a message. \return false at its end
  bool
  next(std::string_view& message, Field& field) const
  {
    if (message.empty())
      return false;
    const std::uint64_t tag = readVarint(message);
    if (tag >> 32 != 0 || tag >> 3 == 0)
      refuse("wrong field number");
    field = {static_cast<std::uint32_t>(tag >> 3), Field::Type(tag & 7), 0, {}};
    switch (field.type) {
    case Field::varint:
      field.value = readVarint(message);
      return true;
    case Field::fixed64:
      return take(message, 8, field);
    case Field::bytes:
      return take(message, readVarint(message), field);
    case Field::fixed32:
      return take(message, 4, field);
    }
    refuse("wrong type of field ", field.number);
  }

  bool
  take(std::string_view& message, std::uint64_t size, Field& field) const
  {
    if (size > message.size())
      refuse("field ", field.number, " states ", size, " bytes, ", message.size(),
             " are left");
    field.data = message.substr(0, size);
    message.remove_prefix(size);
    return true;
  }

  std::string_view
  messageOf(const Field& field) const
  {
    if (field.type != Field::bytes)
      refuse("wrong type of field ", field.number);
    return field.data;
  }

  OnnxInterface
  readGraph(std::string_view graph) const
  {
    OnnxInterface interface;
    std::set<std::string> weights;
    bool has_nodes = false;
    for (Field field; next(graph, field);)
      switch (field.number) {
      case graph_field::node:
        has_nodes = true;
        readOutputs(messageOf(field), interface.inner);
        break;
      case graph_field::initializer:
        weights.insert(nameOfTensor(messageOf(field)));
        break;
      case graph_field::input:
        interface.inputs.push_back(readValue(messageOf(field)));
        break;
      case graph_field::output:
        interface.outputs.push_back(readValue(messageOf(field)).name);
        break;
      }
    if (!has_nodes)
      fail<BadModelException>(path_, ": the network has no nodes");
    interface.inputs.erase(
        std::remove_if(interface.inputs.begin(), interface.inputs.end(),
                       [&](const auto& input) { return weights.count(input.name); }),
        interface.inputs.end());
    return interface;
  }

  void
  readOutputs(std::string_view node, std::vector<std::string>& names) const
  {
    for (Field field; next(node, field);)
      if (field.number == node_field::output)
        names.emplace_back(messageOf(field));
  }

  std::string
  nameOfTensor(std::string_view tensor) const
  {
    std::string name;
    for (Field field; next(tensor, field);)
      if (field.number == tensor_field::name)
        name = messageOf(field);
      else if (field.number == tensor_field::external_data)
        fail<BadModelException>(path_, ": weights '", name,
                                "' lie in another file, which is not supported: "
                                "export the network into one file");
    return name;
  }

  OnnxInterface::Input
  readValue(std::string_view value) const
  {
    OnnxInterface::Input input;
    std::vector<std::string_view> messages{value};
    for (Field field; next(value, field);)
      if (field.number == value_field::name)
        input.name = messageOf(field);
    // The type holds the tensor's, that a shape, that dimensions, each a number or a
    // word.
    for (const std::uint32_t number : {value_field::type, value_field::tensor,
                                       value_field::shape, value_field::dimension})
      messages = messagesWithin(messages, number);
    for (std::string_view dimension : messages) {
      input.size.push_back(-1);
      for (Field field; next(dimension, field);)
        if (field.number == value_field::value && field.type == Field::varint)
          input.size.back() = std::int64_t(field.value);
    }
    return input;
  }

  std::vector<std::string_view>
  messagesWithin(const std::vector<std::string_view>& messages,
                 std::uint32_t number) const
  {
    std::vector<std::string_view> inner;
    for (std::string_view message : messages)
      for (Field field; next(message, field);)
        if (field.number == number && field.type == Field::bytes)
          inner.push_back(field.data);
    return inner;
  }

  const std::string& path_;
};

} // namespace

OnnxInterface
readOnnxInterface(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  return OnnxReader(path).readModel(
      {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

} // namespace pcl_semantic
