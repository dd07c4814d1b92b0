// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_tensor.h"

#include <pcl_semantic/core/exceptions.h>

#include <limits>
#include <vector>

namespace pcl_semantic {

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

std::string
checkOnnxTensor(WireReader message, const std::string& path)
{
  const TensorChecker checker(path);
  const Tensor tensor = checker.readTensor(message);
  checker.checkTensor(tensor);
  return tensor.name;
}

} // namespace pcl_semantic
