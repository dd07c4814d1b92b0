/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "wire_reader.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/onnx_check.h>

#include <limits>

namespace pcl_semantic {

namespace {

// Field numbers of onnx.proto.
namespace model_field {
constexpr std::uint32_t graph = 7;
}
namespace graph_field {
constexpr std::uint32_t node = 1, initializer = 5, sparse_initializer = 15;
}
namespace node_field {
constexpr std::uint32_t input = 1, output = 2, name = 3, operation = 4, attribute = 5;
}
namespace attribute_field {
constexpr std::uint32_t tensor = 5, graph = 6, tensors = 10, graphs = 11,
                        sparse_tensor = 22, sparse_tensors = 23;
}
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

  // A field of another type than its number says is passed over by the reader proper.
  void
  requireType(const WireField& field, WireField::Type type) const
  {
    if (field.type != type)
      refuse("is no ONNX file, or damaged: wrong type of field " +
             std::to_string(field.number));
  }

  void
  checkGraph(WireReader graph) const
  {
    int nodes = 0;
    for (WireField field; graph.next(field);)
      if (field.number == graph_field::node) {
        checkNode(WireReader(field, path_));
        ++nodes;
      }
      else if (field.number == graph_field::initializer)
        checkTensor(readTensor(WireReader(field, path_)));
      else if (field.number == graph_field::sparse_initializer)
        refuse("has sparse tensors, which are not supported");
    if (nodes == 0)
      refuse("the network has no nodes");
  }

  void
  checkNode(WireReader node) const
  {
    std::string name, operation;
    int inputs = 0, outputs = 0;
    for (WireField field; node.next(field);)
      switch (field.number) {
      case node_field::input:
        requireType(field, WireField::bytes);
        ++inputs;
        break;
      case node_field::output:
        requireType(field, WireField::bytes);
        ++outputs;
        break;
      case node_field::name:
        name = text(field);
        break;
      case node_field::operation:
        operation = text(field);
        break;
      case node_field::attribute:
        checkAttribute(WireReader(field, path_));
        break;
      }
    if (operation.empty() || outputs == 0 || (inputs == 0 && operation != "Constant"))
      refuse("node '" + name + "' (" + operation +
             ") lacks operation, inputs or outputs");
  }

  void
  checkAttribute(WireReader attribute) const
  {
    int single_tensors = 0;
    for (WireField field; attribute.next(field);)
      switch (field.number) {
      case attribute_field::tensor:
        // Two would be merged into one, dimensions and all.
        if (++single_tensors > 1)
          refuse("has an attribute with two values");
        [[fallthrough]];
      case attribute_field::tensors:
        checkTensor(readTensor(WireReader(field, path_)));
        break;
      case attribute_field::graph:
      case attribute_field::graphs:
        refuse("has nested graphs, which are not supported");
      case attribute_field::sparse_tensor:
      case attribute_field::sparse_tensors:
        refuse("has sparse tensors, which are not supported");
      }
  }

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
        tensor.name = text(field);
        break;
      case tensor_field::raw_data:
        requireType(field, WireField::bytes);
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
              "tensor '" + tensor.name +
              "' has external, segmented, text or uint64 data, which is not supported");
        break;
      }
    return tensor;
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
      refuse("tensor '" + tensor.name + "' has data of two types");
    tensor.typed_field = field.number;
    const bool floats = field.number == tensor_field::float_data;
    const bool doubles = field.number == tensor_field::double_data;
    if (field.type != WireField::bytes) {
      requireType(field, floats    ? WireField::fixed32
                         : doubles ? WireField::fixed64
                                   : WireField::varint);
      ++tensor.typed_elements;
    }
    else if (floats || doubles) {
      const std::size_t size = floats ? 4 : 8;
      if (field.size % size != 0)
        refuse("tensor '" + tensor.name + "' has a cut-off number");
      tensor.typed_elements += field.size / size;
    }
    else
      for (WireReader packed(field, path_); !packed.atEnd(); ++tensor.typed_elements)
        packed.readVarint();
  }

  void
  checkTensor(const Tensor& tensor) const
  {
    const std::string who = "tensor '" + tensor.name + "' ";
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

  // Names go into messages: one line, printable, short.
  std::string
  text(const WireField& field) const
  {
    constexpr std::size_t longest = 80;
    std::string result;
    for (std::size_t i = 0; i < std::min(field.size, longest); ++i)
      result +=
          field.data[i] >= 0x20 && field.data[i] < 0x7F ? char(field.data[i]) : '?';
    return result;
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
