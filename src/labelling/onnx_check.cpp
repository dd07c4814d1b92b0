// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_tensor.h"
#include "wire_reader.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/onnx_check.h>

#include <limits>
#include <set>

namespace pcl_semantic {

namespace {

// Field numbers of onnx.proto.
namespace model_field {
constexpr std::uint32_t graph = 7;
}
namespace graph_field {
constexpr std::uint32_t node = 1, initializer = 5, input = 11, sparse_initializer = 15;
}
namespace node_field {
constexpr std::uint32_t input = 1, output = 2, name = 3, operation = 4, attribute = 5;
}
namespace value_field {
constexpr std::uint32_t name = 1;
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
};

class OnnxChecker {
public:
  explicit OnnxChecker(const std::string& path) : path_(path) {}

  void
  checkModel(WireReader model)
  {
    int graphs = 0;
    for (WireField field; model.next(field);)
      if (field.number == model_field::graph) {
        checkGraph(WireReader(field, path_));
        ++graphs;
      }
    if (graphs != 1)
      refuse("is no ONNX file: it has " + std::to_string(graphs) +
             " graphs, expected 1");
  }

private:
  [[noreturn]] void
  refuse(const std::string& why) const
  {
    PCL_THROW_EXCEPTION(BadModelException, path_ << ": " << why);
  }

  void
  checkGraph(WireReader graph) const
  {
    std::vector<Node> nodes;
    std::set<std::string> known; // names that a node may take as input
    for (WireField field; graph.next(field);)
      switch (field.number) {
      case graph_field::node:
        nodes.push_back(readNode(WireReader(field, path_)));
        break;
      case graph_field::initializer:
        known.insert(checkOnnxTensor(WireReader(field, path_), path_));
        break;
      case graph_field::input:
        known.insert(readName(WireReader(field, path_)));
        break;
      case graph_field::sparse_initializer:
        refuse("has sparse tensors, which are not supported");
      }
    if (nodes.empty())
      refuse("the network has no nodes");
    for (const Node& node : nodes)
      checkNode(node, known);
  }

  std::string
  readName(WireReader value) const
  {
    std::string name;
    for (WireField field; value.next(field);)
      if (field.number == value_field::name)
        name = textOf(field);
    return name;
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
        checkAttribute(WireReader(field, path_));
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

  void
  checkAttribute(WireReader attribute) const
  {
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
        checkOnnxTensor(WireReader(field, path_), path_);
        break;
      case attribute_field::graph:
      case attribute_field::graphs:
        refuse("has nested graphs, which are not supported");
      case attribute_field::sparse_tensor:
      case attribute_field::sparse_tensors:
        refuse("has sparse tensors, which are not supported");
      }
    checkSizes(name, integers);
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

void
checkOnnx(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  OnnxChecker(path).checkModel(WireReader(bytes.data(), bytes.size(), path));
}

} // namespace pcl_semantic
