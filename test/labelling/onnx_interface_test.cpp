// SPDX-License-Identifier: BSD-3-Clause
#include "labelling/onnx_interface.h"
#include "support/onnx_writer.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pcl_semantic {
namespace {

OnnxInterface
read(const std::string& file)
{
  return readOnnxInterface({file.begin(), file.end()}, "net.onnx");
}

// Refused, in one line that names the file.
void
expectRefused(const std::string& file, const std::string& what)
{
  SCOPED_TRACE(what);
  expectRefusal<BadModelException>("net.onnx: ", [&] { read(file); });
}

PointwiseNetwork
makeNetwork()
{
  PointwiseNetwork network;
  network.channels = 2;
  network.weights = {1, 2, 3, 4, 5, 6};
  network.bias = {7, 8};
  return network;
}

TEST(OnnxInterface, NamesWhatGoesInAndComesOut)
{
  const Message weights = floatTensor("weights", {1}, {1});
  const std::string file = onnxModel(
      Message()
          .message(1, Message().bytes(1, "image").bytes(2, "a").bytes(4, "Relu"))
          .message(1, Message().bytes(1, "a").bytes(2, "b").bytes(4, "Relu"))
          .message(5, weights)
          .message(11, floatValue("image", {1, 3, 6, 8}))
          .message(11, floatValue("weights", {1}))
          .message(12, floatValue("b", {1, 3, 6, 8})));
  const OnnxInterface interface = read(file);
  ASSERT_EQ(interface.inputs.size(), 1u) << "weights are no input";
  EXPECT_EQ(interface.inputs[0].name, "image");
  EXPECT_EQ(interface.inputs[0].size, (std::vector<std::int64_t>{1, 3, 6, 8}));
  EXPECT_EQ(interface.outputs, std::vector<std::string>{"b"});
  EXPECT_EQ(interface.inner, (std::vector<std::string>{"a", "b"}));
}

std::string
withWeights(const Message& tensor)
{
  Message named = tensor;
  return makeNetwork().withTensors(named.bytes(8, "weights"),
                                   floatTensor("bias", {2}, {7, 8}));
}

TEST(OnnxInterface, AcceptsEveryWayToStoreATensor)
{
  EXPECT_NO_THROW(read(makeNetwork().file()));
  const std::string packed(24, '\0');
  const auto dims = [] { return Message().number(1, 2).number(1, 3).number(2, 1); };
  EXPECT_NO_THROW(read(withWeights(dims().bytes(4, packed)))) << "packed floats";
  const Message packed_dims =
      Message().bytes(1, std::string("\x02\x03")).number(2, 1).bytes(9, packed);
  EXPECT_NO_THROW(read(withWeights(packed_dims)));
  const Message int64 =
      Message().number(1, 3).number(2, 7).bytes(7, std::string("\x01\x80\x01\x05"));
  EXPECT_NO_THROW(read(withWeights(int64))) << "three packed numbers";
  EXPECT_NO_THROW(read(withWeights(Message().number(2, 7).number(7, 5)))) << "scalar";
}

// TensorProto.DataType, as onnx.proto numbers them, and the bytes of an element.
TEST(OnnxInterface, KnowsTheSizeOfEveryType)
{
  const std::map<int, int> sizes = {{1, 4}, {2, 1}, {3, 1},  {6, 4},
                                    {7, 8}, {9, 1}, {10, 2}, {11, 8}};
  for (int type = 0; type <= 20; ++type) {
    const auto tensor = [&](int bytes) {
      return withWeights(Message()
                             .number(1, 5)
                             .number(2, std::uint64_t(type))
                             .bytes(9, std::string(std::size_t(5 * bytes), '\0')));
    };
    const auto size = sizes.find(type);
    if (size != sizes.end()) {
      EXPECT_NO_THROW(read(tensor(size->second))) << type;
    }
    for (const int other : {1, 2, 4, 8})
      if (size == sizes.end() || other != size->second)
        expectRefused(tensor(other), "type " + std::to_string(type));
  }
}

TEST(OnnxInterface, RefusesDimensionsThatTheDataDoNotFill)
{
  const std::uint64_t large = std::uint64_t(1) << 28;
  const auto tensor = [](const std::vector<std::uint64_t>& dims, std::size_t count) {
    return withWeights(floatTensor("weights", dims, std::vector<float>(count, 1.0f)));
  };
  EXPECT_NO_THROW(read(tensor({2, 3, 1, 1}, 6)));
  expectRefusal<BadModelException>("'weights' has 6 elements, its dimensions state 8",
                                   [&] {
                                     read(tensor({2, 4, 1, 1}, 6));
                                   });
  expectRefused(tensor({2, 2, 1, 1}, 6), "less than data");
  expectRefused(tensor({2, 3, 1, 1}, 0), "no data");
  expectRefused(tensor({large << 12}, 6), "2^40");
  expectRefused(tensor({large, 3, 1, 1}, 6), "2^28");
  expectRefused(tensor({large, large, large}, 6), "2^84");
  // 2^32 x 2^32 is 0 in 64 bits, and so is the stored size.
  expectRefused(tensor({large << 4, large << 4}, 0), "wraps to 0");
  expectRefused(tensor({std::uint64_t(-6)}, 6), "negative");
}

TEST(OnnxInterface, RefusesDataOfTheWrongKind)
{
  const auto dims = [](int type) { return Message().number(1, 6).number(2, type); };
  const auto bytes = [&](int type, std::uint32_t field, std::size_t size) {
    return dims(type).bytes(field, std::string(size, 'x'));
  };
  Message numbers = dims(1);
  for (int i = 0; i < 6; ++i)
    numbers.number(4, 0);
  for (const auto& [tensor, what] : std::vector<std::pair<Message, std::string>>{
           {bytes(1, 9, 23), "one byte short"},
           {bytes(1, 9, 25), "one byte long"},
           {bytes(1, 4, 23), "cut-off floats"},
           {bytes(1, 10, 48), "doubles for floats"},
           {bytes(7, 9, 24), "int64 of 4 bytes"},
           {bytes(8, 6, 6), "text"},
           {bytes(99, 9, 24), "unknown type"},
           {dims(1).number(14, 1), "external data"},
           {dims(1).bytes(13, "location: weights.bin"), "external data, where"},
           {dims(1).number(9, 24), "raw data that is a number"},
           {bytes(1, 4, 24).bytes(9, std::string(24, 'x')), "both"},
           {numbers, "floats stored as integers"}})
    expectRefused(withWeights(tensor), what);
}

TEST(OnnxInterface, LooksIntoConstantsOfNodes)
{
  const auto graph = [](const Message& attribute) {
    const Message node =
        Message().bytes(2, "out").bytes(4, "Constant").message(5, attribute);
    return onnxModel(Message().message(1, node));
  };
  const auto attribute = [](const Message& tensor) {
    return Message().bytes(1, "value").message(5, tensor).number(20, 4);
  };
  EXPECT_NO_THROW(read(graph(attribute(floatTensor("", {2}, {1, 2})))));
  expectRefused(graph(attribute(floatTensor("", {3}, {1, 2}))), "constant");
  // Well formed each, but a reader of protocol buffers merges them into one of 2 x 2.
  Message twice = attribute(floatTensor("", {2}, {1, 2}));
  twice.message(5, floatTensor("", {2}, {1, 2}));
  expectRefused(graph(twice), "two values");
}

TEST(OnnxInterface, RefusesWhatIsNoNetwork)
{
  expectRefused("", "empty file");
  expectRefused(onnxModel(Message()), "no nodes");
  const std::string file = makeNetwork().file();
  expectRefused(file + file, "two graphs");
  expectRefused(std::string(11, '\xFF'), "endless number");
  expectRefused(std::string("\x0B", 1), "group");
  expectRefused(std::string("\x00\x00", 2), "field 0");
}

TEST(OnnxInterface, RefusesRandomBytesAndEveryTruncation)
{
  std::mt19937 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string file(1 + random() % 300, '\0');
    for (char& byte : file)
      byte = static_cast<char>(random());
    expectRefused(file, "random bytes");
  }
  const std::string whole = makeNetwork().file();
  for (std::size_t size = 0; size < whole.size(); ++size)
    expectRefused(whole.substr(0, size), "cut off at " + std::to_string(size));
}

} // namespace
} // namespace pcl_semantic
