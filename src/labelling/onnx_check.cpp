// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_check.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief A field of a protocol buffer message. */
struct WireField {
  enum Type { varint = 0, fixed64 = 1, bytes = 2, fixed32 = 5 };

  std::uint32_t number = 0;
  Type type = varint;
  std::uint64_t value = 0;            ///< of a varint
  const std::uint8_t* data = nullptr; ///< of the other types
  std::size_t size = 0;               ///< of \a data [bytes]
};

/** \brief Reads the fields of a protocol buffer message one after the other, never
 * beyond its end. */
class WireReader {
public:
  /** \param[in] data message; has to outlive the reader
   * \param[in] path for messages */
  WireReader(const std::uint8_t* data, std::size_t size, const std::string& path)
      : at_(data), end_(data + size), path_(path)
  {}

  /** \brief The message in a field of type bytes.
   * \throws BadModelException if it is of another type */
  WireReader(const WireField& field, const std::string& path);

  /** \return false at the end of the message
   * \throws BadModelException if the bytes are no well-formed message */
  bool next(WireField& field);

  bool
  atEnd() const
  {
    return at_ == end_;
  }

  /** \throws BadModelException if the bytes end before it does, or it is too long */
  std::uint64_t readVarint();

private:
  void take(std::uint64_t size, WireField& field);

  const std::uint8_t* at_;
  const std::uint8_t* end_;
  const std::string& path_;
};

/** \brief A field of another type than its number says would be passed over by the
 * reader proper. \throws BadModelException */
void requireType(const WireField& field, WireField::Type type, const std::string& path);

/** \brief The text of a field of type bytes. */
std::string textOf(const WireField& field);

/** \brief A text from the file as messages may show it: one line, printable, short. */
std::string printable(const std::string& text);

/** \brief What is known of a checked tensor. */
struct OnnxTensor {
  std::string name;
  bool is_empty = false; ///< has no element
};

/** \brief Checks a TensorProto: it has exactly the data that its dimensions state, in
 * the file itself and of a type that OpenCV reads. \throws BadModelException */
OnnxTensor checkOnnxTensor(WireReader message, const std::string& path);

WireReader::WireReader(const WireField& field, const std::string& path)
    : WireReader(field.data, field.size, path)
{
  requireType(field, WireField::bytes, path);
}

bool
WireReader::next(WireField& field)
{
  if (atEnd())
    return false;
  const std::uint64_t tag = readVarint();
  if (tag >> 32 != 0 || tag >> 3 == 0)
    PCL_THROW_EXCEPTION(BadModelException,
                        path_ << ": is no ONNX file, or damaged: wrong field number");
  field = WireField();
  field.number = static_cast<std::uint32_t>(tag >> 3);
  switch (tag & 7) {
  case WireField::varint:
    field.value = readVarint();
    break;
  case WireField::fixed64:
    field.type = WireField::fixed64;
    take(8, field);
    break;
  case WireField::bytes:
    field.type = WireField::bytes;
    take(readVarint(), field);
    break;
  case WireField::fixed32:
    field.type = WireField::fixed32;
    take(4, field);
    break;
  default:
    PCL_THROW_EXCEPTION(BadModelException,
                        path_ << ": is no ONNX file, or damaged: wrong type of field "
                              << field.number);
  }
  return true;
}

std::uint64_t
WireReader::readVarint()
{
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && at_ != end_; shift += 7) {
    const std::uint64_t byte = *at_++;
    if (shift == 63 && byte > 1)
      break;
    value |= (byte & 0x7F) << shift;
    if (byte < 0x80)
      return value;
  }
  PCL_THROW_EXCEPTION(BadModelException,
                      path_ << ": is no ONNX file, or damaged: a number is cut off");
}

void
WireReader::take(std::uint64_t size, WireField& field)
{
  if (size > static_cast<std::uint64_t>(end_ - at_))
    PCL_THROW_EXCEPTION(BadModelException,
                        path_ << ": is no ONNX file, or damaged: field " << field.number
                              << " states " << size << " bytes, " << (end_ - at_)
                              << " are left");
  field.data = at_;
  field.size = static_cast<std::size_t>(size);
  at_ += size;
}

void
requireType(const WireField& field, WireField::Type type, const std::string& path)
{
  if (field.type != type)
    PCL_THROW_EXCEPTION(BadModelException,
                        path << ": is no ONNX file, or damaged: wrong type of field "
                             << field.number);
}

std::string
textOf(const WireField& field)
{
  return std::string(field.data, field.data + field.size);
}

std::string
printable(const std::string& text)
{
  constexpr std::size_t longest = 80;
  std::string result = text.substr(0, longest);
  for (char& c : result)
    if (c < 0x20 || c > 0x7E)
      c = '?';
  return result;
}

namespace {

// Field numbers of TensorProto in onnx.proto.
namespace tensor_field {
constexpr std::uint32_t dims = 1, type = 2, segment = 3, float_data = 4, int32_data = 5,
                        string_data = 6, int64_data = 7, name = 8, raw_data = 9,
                        double_data = 10, uint64_data = 11, external_data = 13,
                        location = 14;
}

// How the elements of a tensor are stored if not as raw bytes.
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
  std::uint32_t typed_field = 0; // the field that holds the elements, if not raw
  std::uint64_t typed_elements = 0;
};

class TensorChecker {
public:
  explicit TensorChecker(const std::string& path) : path_(path) {}

  Tensor
  readTensor(WireReader message) const
  {
    Tensor tensor;
    for (WireField field; message.next(field);)
      switch (field.number) {
      case tensor_field::dims:
        readDims(field, tensor);
        break;
      case tensor_field::type:
        tensor.type = field.value;
        break;
      case tensor_field::name:
        tensor.name = textOf(field);
        break;
      case tensor_field::raw_data:
        requireType(field, WireField::bytes, path_);
        tensor.raw_bytes = field.size;
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
        if (field.type != WireField::varint || field.value != 0)
          refuse(
              "tensor '" + printable(tensor.name) +
              "' has external, segmented, text or uint64 data, which is not supported");
        break;
      }
    return tensor;
  }

  void
  checkTensor(const Tensor& tensor) const
  {
    const std::string who = "tensor '" + printable(tensor.name) + "' ";
    std::uint64_t elements = 1;
    constexpr std::uint64_t limit = std::numeric_limits<std::int32_t>::max();
    for (const std::uint64_t dim : tensor.dims) {
      if (dim > limit || (dim != 0 && elements > limit / dim))
        refuse(who + "has impossible dimensions");
      elements *= dim;
    }
    for (const ElementType& type : element_types) {
      if (type.type != tensor.type)
        continue;
      if (tensor.typed_field != 0 &&
          (tensor.typed_field != type.field || tensor.raw_bytes != 0))
        refuse(who + "has data of two types");
      if (tensor.raw_bytes % type.size != 0)
        refuse(who + "has a cut-off number");
      const std::uint64_t stored = tensor.raw_bytes / type.size + tensor.typed_elements;
      if (stored != elements)
        refuse(who + "has " + std::to_string(stored) +
               " elements, its dimensions state " + std::to_string(elements));
      return;
    }
    refuse(who + "has data type " + std::to_string(tensor.type) +
           ", which is not supported");
  }

private:
  [[noreturn]] void
  refuse(const std::string& why) const
  {
    PCL_THROW_EXCEPTION(BadModelException, path_ << ": " << why);
  }

  // Repeated numbers come one a field, or packed into one.
  void
  readDims(const WireField& field, Tensor& tensor) const
  {
    if (field.type == WireField::varint) {
      tensor.dims.push_back(field.value);
      return;
    }
    for (WireReader packed(field, path_); !packed.atEnd();)
      tensor.dims.push_back(packed.readVarint());
  }

  void
  countElements(const WireField& field, Tensor& tensor) const
  {
    if (tensor.typed_field != 0 && tensor.typed_field != field.number)
      refuse("tensor '" + printable(tensor.name) + "' has data of two types");
    tensor.typed_field = field.number;
    const bool floats = field.number == tensor_field::float_data;
    const bool doubles = field.number == tensor_field::double_data;
    if (field.type != WireField::bytes) {
      requireType(field,
                  floats    ? WireField::fixed32
                  : doubles ? WireField::fixed64
                            : WireField::varint,
                  path_);
      ++tensor.typed_elements;
    }
    else if (floats || doubles) {
      const std::size_t size = floats ? 4 : 8;
      if (field.size % size != 0)
        refuse("tensor '" + printable(tensor.name) + "' has a cut-off number");
      tensor.typed_elements += field.size / size;
    }
    else
      for (WireReader packed(field, path_); !packed.atEnd(); ++tensor.typed_elements)
        packed.readVarint();
  }

  const std::string& path_;
};

} // namespace

OnnxTensor
checkOnnxTensor(WireReader message, const std::string& path)
{
  const TensorChecker checker(path);
  const Tensor tensor = checker.readTensor(message);
  checker.checkTensor(tensor);
  return {tensor.name, tensor.raw_bytes == 0 && tensor.typed_elements == 0};
}

namespace {

// Field numbers of onnx.proto.
namespace model_field {
constexpr std::uint32_t graph = 7;
}
namespace graph_field {
constexpr std::uint32_t node = 1, initializer = 5, input = 11, output = 12,
                        sparse_initializer = 15;
}
namespace node_field {
constexpr std::uint32_t input = 1, output = 2, name = 3, operation = 4, attribute = 5;
}
namespace value_field { // and of the messages within its type
constexpr std::uint32_t name = 1, type = 2, tensor = 1, shape = 2, dimension = 1,
                        value = 1;
}
namespace attribute_field {
constexpr std::uint32_t name = 1, integer = 3, integers = 8, tensor = 5, graph = 6,
                        tensors = 10, graphs = 11, sparse_tensor = 22,
                        sparse_tensors = 23;
}

struct Node {
  std::string name;
  std::string operation;
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  bool has_empty_value = false; // an attribute is a tensor without elements
};

class OnnxChecker {
public:
  explicit OnnxChecker(const std::string& path) : path_(path) {}

  OnnxInterface
  checkModel(WireReader model)
  {
    OnnxInterface interface;
    int graphs = 0;
    for (WireField field; model.next(field);)
      if (field.number == model_field::graph) {
        interface = checkGraph(WireReader(field, path_));
        ++graphs;
      }
    if (graphs != 1)
      refuse("is no ONNX file: it has " + std::to_string(graphs) +
             " graphs, expected 1");
    return interface;
  }

private:
  [[noreturn]] void
  refuse(const std::string& why) const
  {
    PCL_THROW_EXCEPTION(BadModelException, path_ << ": " << why);
  }

  OnnxInterface
  checkGraph(WireReader graph) const
  {
    OnnxInterface interface;
    std::vector<Node> nodes;
    std::set<std::string> weights, empty;
    for (WireField field; graph.next(field);)
      switch (field.number) {
      case graph_field::node:
        nodes.push_back(readNode(WireReader(field, path_)));
        break;
      case graph_field::initializer: {
        const OnnxTensor tensor = checkOnnxTensor(WireReader(field, path_), path_);
        weights.insert(tensor.name);
        if (tensor.is_empty)
          empty.insert(tensor.name);
        break;
      }
      case graph_field::input:
        interface.inputs.push_back(readInput(WireReader(field, path_)));
        break;
      case graph_field::output:
        interface.outputs.push_back(readInput(WireReader(field, path_)).name);
        break;
      case graph_field::sparse_initializer:
        refuse("has sparse tensors, which are not supported");
      }
    if (nodes.empty())
      refuse("the network has no nodes");
    std::set<std::string> known = weights; // names that a node may take as input
    for (const OnnxInterface::Input& input : interface.inputs)
      known.insert(input.name);
    for (const Node& node : nodes) {
      checkNode(node, known);
      checkOperands(node, empty);
      interface.inner.insert(interface.inner.end(), node.outputs.begin(),
                             node.outputs.end());
    }
    interface.inputs.erase(
        std::remove_if(interface.inputs.begin(), interface.inputs.end(),
                       [&](const auto& input) { return weights.count(input.name); }),
        interface.inputs.end());
    return interface;
  }

  OnnxInterface::Input
  readInput(WireReader value) const
  {
    OnnxInterface::Input input;
    for (WireField field; value.next(field);)
      if (field.number == value_field::name)
        input.name = textOf(field);
      else if (field.number == value_field::type && field.type == WireField::bytes)
        readSize(WireReader(field, path_), input.size);
    return input;
  }

  // The type holds the tensor's, that a shape, that dimensions, each a number or a
  // word.
  void
  readSize(WireReader type, std::vector<std::int64_t>& size) const
  {
    const auto forEach = [&](WireReader message, std::uint32_t number, auto&& visit) {
      for (WireField field; message.next(field);)
        if (field.number == number && field.type == WireField::bytes)
          visit(WireReader(field, path_));
    };
    forEach(type, value_field::tensor, [&](const WireReader& tensor) {
      forEach(tensor, value_field::shape, [&](const WireReader& shape) {
        forEach(shape, value_field::dimension, [&](WireReader dimension) {
          size.push_back(-1);
          for (WireField field; dimension.next(field);)
            if (field.number == value_field::value && field.type == WireField::varint)
              size.back() = std::int64_t(field.value);
        });
      });
    });
  }

  Node
  readNode(WireReader message) const
  {
    Node node;
    for (WireField field; message.next(field);)
      switch (field.number) {
      case node_field::input:
        requireType(field, WireField::bytes, path_);
        node.inputs.push_back(textOf(field));
        break;
      case node_field::output:
        requireType(field, WireField::bytes, path_);
        node.outputs.push_back(textOf(field));
        break;
      case node_field::name:
        node.name = printable(textOf(field));
        break;
      case node_field::operation:
        node.operation = printable(textOf(field));
        break;
      case node_field::attribute:
        node.has_empty_value |= checkAttribute(WireReader(field, path_));
        break;
      }
    return node;
  }

  // Nodes come in the order of execution: an input is there before its node.
  void
  checkNode(const Node& node, std::set<std::string>& known) const
  {
    const std::string who = "node '" + node.name + "' (" + node.operation + ") ";
    if (node.operation.empty() || node.outputs.empty() ||
        (node.inputs.empty() && node.operation != "Constant"))
      refuse(who + "lacks operation, inputs or outputs");
    for (std::size_t i = 0; i < node.inputs.size(); ++i)
      if (!node.inputs[i].empty() && known.count(node.inputs[i]) == 0)
        refuse(who + "takes an input that nothing gives: number " + std::to_string(i));
    known.insert(node.outputs.begin(), node.outputs.end());
  }

  // OpenCV 4.6 takes these for granted, and divides by the size of weights.
  void
  checkOperands(const Node& node, const std::set<std::string>& empty) const
  {
    static const std::set<std::string> of_two = {
        "Add",    "Sub",  "Mul",    "Div",    "Pow",  "CumSum",
        "MatMul", "Gemm", "Expand", "Gather", "Conv", "ConvTranspose"};
    const std::string who = "node '" + node.name + "' (" + node.operation + ") ";
    if (node.operation == "ConstantOfShape" && node.has_empty_value)
      refuse(who + "has an empty value");
    if (!of_two.count(node.operation))
      return;
    if (node.inputs.size() < 2)
      refuse(who + "has one input, expected two");
    for (const std::string& input : node.inputs)
      if (empty.count(input))
        refuse(who + "takes a tensor without elements: '" + printable(input) + "'");
  }

  // \return whether it is a tensor without elements
  bool
  checkAttribute(WireReader attribute) const
  {
    bool is_empty = false;
    int single_tensors = 0;
    std::string name;
    std::vector<std::uint64_t> integers;
    for (WireField field; attribute.next(field);)
      switch (field.number) {
      case attribute_field::name:
        name = printable(textOf(field));
        break;
      case attribute_field::integer:
      case attribute_field::integers:
        readIntegers(field, integers);
        break;
      case attribute_field::tensor:
        // Two would be merged into one, dimensions and all.
        if (++single_tensors > 1)
          refuse("has an attribute with two values");
        [[fallthrough]];
      case attribute_field::tensors:
        is_empty = checkOnnxTensor(WireReader(field, path_), path_).is_empty;
        break;
      case attribute_field::graph:
      case attribute_field::graphs:
        refuse("has nested graphs, which are not supported");
      case attribute_field::sparse_tensor:
      case attribute_field::sparse_tensors:
        refuse("has sparse tensors, which are not supported");
      }
    checkSizes(name, integers);
    return is_empty;
  }

  void
  readIntegers(const WireField& field, std::vector<std::uint64_t>& integers) const
  {
    if (field.type == WireField::varint) {
      integers.push_back(field.value);
      return;
    }
    for (WireReader packed(field, path_); !packed.atEnd();)
      integers.push_back(packed.readVarint());
  }

  // OpenCV divides by these.
  void
  checkSizes(const std::string& name, const std::vector<std::uint64_t>& integers) const
  {
    if (name != "group" && name != "kernel_shape" && name != "strides" &&
        name != "dilations")
      return;
    constexpr std::uint64_t largest = std::numeric_limits<std::int16_t>::max();
    for (const std::uint64_t value : integers)
      if (value == 0 || value > largest)
        refuse("attribute '" + name + "' is not within 1 to " +
               std::to_string(largest));
    if (integers.empty())
      refuse("attribute '" + name + "' has no value");
  }

  const std::string& path_;
};

} // namespace

OnnxInterface
checkOnnx(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  return OnnxChecker(path).checkModel(WireReader(bytes.data(), bytes.size(), path));
}

} // namespace pcl_semantic
