// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_interface.h"
#include "core/fail.h"

#include <algorithm>
#include <iterator>
#include <limits>
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
constexpr std::uint32_t graph = 7, functions = 25;
}
namespace graph_field {
constexpr std::uint32_t node = 1, initializer = 5, input = 11, output = 12;
}
namespace node_field {
constexpr std::uint32_t output = 2, attribute = 5;
}
namespace attribute_field {
constexpr std::uint32_t tensor = 5, tensors = 10;
}
namespace tensor_field {
constexpr std::uint32_t dims = 1, type = 2, segment = 3, float_data = 4, int32_data = 5,
                        string_data = 6, int64_data = 7, name = 8, raw_data = 9,
                        double_data = 10, uint64_data = 11, external_data = 13,
                        location = 14;
}

namespace value_field { // and of the messages within its type
constexpr std::uint32_t name = 1, type = 2, tensor = 1, shape = 2, dimension = 1,
                        value = 1;
}

// Storage of a tensor's elements, if not as raw bytes.
struct ElementType {
  std::uint64_t type;
  std::uint64_t size; // in raw_data [bytes]
  std::uint32_t field;
};

constexpr ElementType element_types[] = {{1, 4, tensor_field::float_data},  // float
                                         {2, 1, tensor_field::int32_data},  // uint8
                                         {3, 1, tensor_field::int32_data},  // int8
                                         {6, 4, tensor_field::int32_data},  // int32
                                         {7, 8, tensor_field::int64_data},  // int64
                                         {9, 1, tensor_field::int32_data},  // bool
                                         {10, 2, tensor_field::int32_data}, // float16
                                         {11, 8, tensor_field::double_data}};

struct Tensor {
  std::string name;
  std::vector<std::uint64_t> dims;
  std::uint64_t type = 0;
  std::uint64_t raw_bytes = 0;
  std::uint32_t typed_field = 0; // the field of the elements, if not raw
  std::uint64_t typed_elements = 0;
};

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
      else if (field.number == model_field::functions)
        refuseContent("has functions of its own, which are not supported");
    if (graphs != 1)
      refuseContent("is no ONNX file: it has ", graphs, " graphs, expected 1");
    return interface;
  }

private:
  template <typename... Parts>
  [[noreturn]] void
  refuseContent(const Parts&... why) const
  {
    fail<BadModelException>(path_, ": ", why...);
  }

  template <typename... Parts>
  [[noreturn]] void
  refuse(const Parts&... why) const
  {
    refuseContent("is no ONNX file, or damaged: ", why...);
  }

  // Reads a number and removes it from the beginning of the bytes.
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

  // Reads a field and removes it from the message. \return false at its end
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
        readNode(messageOf(field), interface.inner);
        break;
      case graph_field::initializer:
        weights.insert(checkTensor(messageOf(field)).name);
        break;
      case graph_field::input:
        interface.inputs.push_back(readValue(messageOf(field)));
        break;
      case graph_field::output:
        interface.outputs.push_back(readValue(messageOf(field)).name);
        break;
      }
    if (!has_nodes)
      refuseContent("the network has no nodes");
    interface.inputs.erase(
        std::remove_if(interface.inputs.begin(), interface.inputs.end(),
                       [&](const auto& input) { return weights.count(input.name); }),
        interface.inputs.end());
    return interface;
  }

  void
  readNode(std::string_view node, std::vector<std::string>& outputs) const
  {
    for (Field field; next(node, field);)
      if (field.number == node_field::output)
        outputs.emplace_back(messageOf(field));
      else if (field.number == node_field::attribute)
        checkAttribute(messageOf(field));
  }

  // Repeated numbers have one field each, or share a packed field.
  template <typename Visit>
  void
  forEachNumber(const Field& field, const Visit& visit) const
  {
    if (field.type == Field::varint)
      return visit(field.value);
    for (std::string_view packed = messageOf(field); !packed.empty();)
      visit(readVarint(packed));
  }

  // Requires the amount of data that the dimensions of a TensorProto state, stored in
  // this file and of a type that OpenCV reads.
  Tensor
  checkTensor(std::string_view message) const
  {
    const Tensor tensor = readTensor(message);
    const std::string subject = "tensor '" + tensor.name.substr(0, 80) + "' ";
    std::uint64_t elements = 1;
    constexpr std::uint64_t limit = std::numeric_limits<std::int32_t>::max();
    for (const std::uint64_t dim : tensor.dims) {
      if (dim > limit || (dim != 0 && elements > limit / dim))
        refuseContent(subject, "has negative or too large dimensions");
      elements *= dim;
    }
    const auto type =
        std::find_if(std::begin(element_types), std::end(element_types),
                     [&](const ElementType& each) { return each.type == tensor.type; });
    if (type == std::end(element_types))
      refuseContent(subject, "has data type ", tensor.type, ", which is not supported");
    if (tensor.typed_field != 0 &&
        (tensor.typed_field != type->field || tensor.raw_bytes != 0))
      refuseContent(subject, "has data of two types");
    if (tensor.raw_bytes % type->size != 0)
      refuseContent(subject, "has a cut-off number");
    const std::uint64_t stored = tensor.raw_bytes / type->size + tensor.typed_elements;
    if (stored != elements)
      refuseContent(subject, "has ", stored, " elements, its dimensions state ",
                    elements);
    return tensor;
  }

  Tensor
  readTensor(std::string_view message) const
  {
    Tensor tensor;
    for (Field field; next(message, field);)
      switch (field.number) {
      case tensor_field::dims:
        forEachNumber(field, [&](std::uint64_t dim) { tensor.dims.push_back(dim); });
        break;
      case tensor_field::type:
        tensor.type = field.value;
        break;
      case tensor_field::name:
        tensor.name = field.data;
        break;
      case tensor_field::raw_data:
        tensor.raw_bytes = messageOf(field).size();
        break;
      case tensor_field::float_data:
      case tensor_field::int32_data:
      case tensor_field::int64_data:
      case tensor_field::double_data:
        countElements(field, tensor);
        break;
      case tensor_field::segment:
      case tensor_field::string_data:
      case tensor_field::uint64_data:
      case tensor_field::external_data:
      case tensor_field::location:
        if (field.type != Field::varint || field.value != 0)
          refuseContent("tensor '", tensor.name,
                        "' has external, segmented, text or uint64 data, which is not "
                        "supported");
        break;
      }
    return tensor;
  }

  void
  countElements(const Field& field, Tensor& tensor) const
  {
    if (tensor.typed_field != 0 && tensor.typed_field != field.number)
      refuseContent("tensor '", tensor.name, "' has data of two types");
    tensor.typed_field = field.number;
    const bool floats = field.number == tensor_field::float_data;
    if (!floats && field.number != tensor_field::double_data) {
      forEachNumber(field, [&](std::uint64_t) { ++tensor.typed_elements; });
      return;
    }
    const bool is_single = field.type == (floats ? Field::fixed32 : Field::fixed64);
    const std::size_t bytes = is_single ? field.data.size() : messageOf(field).size();
    const std::size_t size = floats ? 4 : 8;
    if (bytes % size != 0)
      refuseContent("tensor '", tensor.name, "' has a cut-off number");
    tensor.typed_elements += bytes / size;
  }

  // Weights may be constants in nodes.
  void
  checkAttribute(std::string_view attribute) const
  {
    int single_tensors = 0;
    for (Field field; next(attribute, field);)
      if (field.number == attribute_field::tensor ||
          field.number == attribute_field::tensors) {
        checkTensor(messageOf(field));
        single_tensors += field.number == attribute_field::tensor;
      }
    if (single_tensors > 1) // OpenCV would merge them, including their dimensions
      refuseContent("has an attribute with two values");
  }

  OnnxInterface::Input
  readValue(std::string_view value) const
  {
    OnnxInterface::Input input;
    std::vector<std::string_view> messages{value};
    for (Field field; next(value, field);)
      if (field.number == value_field::name)
        input.name = messageOf(field);
    // Nesting: type, tensor, shape, dimensions. A dimension is a number or a name.
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
