// SPDX-License-Identifier: BSD-3-Clause
#include "labelling/onnx_check.h"

#include <pcl_semantic/core/exceptions.h>

#include <support/onnx_writer.h>

#include <gtest/gtest.h>

#include <random>

namespace pcl_semantic {
namespace {

void
check(const std::string& file)
{
  checkOnnx(std::vector<std::uint8_t>(file.begin(), file.end()), "net.onnx");
}

// Refused, in one line that names the file.
void
expectRefused(const std::string& file, const std::string& what)
{
  try {
    check(file);
    ADD_FAILURE() << "accepted: " << what;
  }
  catch (const BadModelException& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind("net.onnx: ", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
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

std::string
withWeights(const Message& tensor)
{
  Message named = tensor;
  return makeNetwork().withTensors(named.bytes(8, "weights"),
                                   floatTensor("bias", {2}, {7, 8}));
}

TEST(OnnxCheck, AcceptsEveryWayToStoreATensor)
{
  EXPECT_NO_THROW(check(makeNetwork().file()));
  const std::string packed(24, '\0');
  const auto dims = [] { return Message().number(1, 2).number(1, 3).number(2, 1); };
  EXPECT_NO_THROW(check(withWeights(dims().bytes(4, packed)))) << "packed floats";
  const Message packed_dims =
      Message().bytes(1, std::string("\x02\x03")).number(2, 1).bytes(9, packed);
  EXPECT_NO_THROW(check(withWeights(packed_dims)));
  const Message int64 =
      Message().number(1, 3).number(2, 7).bytes(7, std::string("\x01\x80\x01\x05"));
  EXPECT_NO_THROW(check(withWeights(int64))) << "three packed numbers";
  EXPECT_NO_THROW(check(withWeights(Message().number(2, 7).number(7, 5)))) << "scalar";
}

TEST(OnnxCheck, RefusesDimensionsThatTheDataDoNotFill)
{
  const std::vector<float> six(6, 1.0f);
  const std::uint64_t huge = std::uint64_t(1) << 40;
  const std::uint64_t large = std::uint64_t(1) << 28;
  EXPECT_NO_THROW(check(withWeights(floatTensor("weights", {2, 3, 1, 1}, six))));
  expectRefused(withWeights(floatTensor("weights", {2, 4, 1, 1}, six)),
                "more than data");
  expectRefused(withWeights(floatTensor("weights", {2, 2, 1, 1}, six)),
                "less than data");
  expectRefused(withWeights(floatTensor("weights", {huge}, six)), "2^40");
  expectRefused(withWeights(floatTensor("weights", {large, 3, 1, 1}, six)), "2^28");
  expectRefused(withWeights(floatTensor("weights", {large, large, large}, six)),
                "2^84");
  // 2^32 x 2^32 is 0 in 64 bits, and so is what is stored.
  expectRefused(withWeights(floatTensor("w", {huge >> 8, huge >> 8}, {})),
                "wraps to 0");
  expectRefused(withWeights(floatTensor("weights", {std::uint64_t(-6)}, six)),
                "negative");
  expectRefused(withWeights(floatTensor("weights", {2, 3, 1, 1}, {})), "no data");
}

TEST(OnnxCheck, RefusesDataOfTheWrongKind)
{
  const auto dims = [](int type) { return Message().number(1, 6).number(2, type); };
  expectRefused(withWeights(dims(1).bytes(9, std::string(23, 'x'))), "one byte short");
  expectRefused(withWeights(dims(1).bytes(9, std::string(25, 'x'))), "one byte long");
  expectRefused(withWeights(dims(1).bytes(4, std::string(23, 'x'))), "cut-off floats");
  expectRefused(withWeights(dims(1).bytes(10, std::string(48, 'x'))),
                "doubles for floats");
  expectRefused(withWeights(dims(7).bytes(9, std::string(24, 'x'))),
                "int64 of 4 bytes");
  expectRefused(withWeights(dims(8).bytes(6, "abcdef")), "text");
  expectRefused(withWeights(dims(99).bytes(9, std::string(24, 'x'))), "unknown type");
  expectRefused(withWeights(dims(1).number(14, 1)), "external data");
  expectRefused(withWeights(dims(1).number(9, 24)), "raw data that is a number");
  const std::string six_floats(24, 'x');
  expectRefused(withWeights(dims(1).bytes(4, six_floats).bytes(9, six_floats)), "both");
  Message numbers = dims(1);
  for (int i = 0; i < 6; ++i)
    numbers.number(4, 0);
  expectRefused(withWeights(numbers), "floats stored as integers");
}

TEST(OnnxCheck, LooksIntoConstantsOfNodes)
{
  const auto graph = [](const Message& attribute) {
    const Message node =
        Message().bytes(2, "out").bytes(4, "Constant").message(5, attribute);
    return onnxModel(Message().message(1, node));
  };
  const auto attribute = [](const Message& tensor) {
    return Message().bytes(1, "value").message(5, tensor).number(20, 4);
  };
  EXPECT_NO_THROW(check(graph(attribute(floatTensor("", {2}, {1, 2})))));
  expectRefused(graph(attribute(floatTensor("", {3}, {1, 2}))), "constant");
  // Well formed each, but a reader of protocol buffers merges them into one of 2 x 2.
  Message twice = attribute(floatTensor("", {2}, {1, 2}));
  twice.message(5, floatTensor("", {2}, {1, 2}));
  expectRefused(graph(twice), "two values");
  expectRefused(graph(Message().bytes(1, "body").message(6, Message())),
                "nested graph");
}

TEST(OnnxCheck, RefusesWhatIsNoNetwork)
{
  expectRefused("", "empty file");
  expectRefused(onnxModel(Message()), "no nodes");
  expectRefused(onnxModel(Message().message(1, Message())), "empty node");
  const std::string file = makeNetwork().file();
  expectRefused(file + file, "two graphs");
  expectRefused(std::string(11, '\xFF'), "endless number");
  expectRefused(std::string("\x0B", 1), "group");
  expectRefused(std::string("\x00\x00", 2), "field 0");
}

TEST(OnnxCheck, RefusesInputsThatNothingGives)
{
  const auto replaced = [](const std::string& from, const std::string& to) {
    std::string file = makeNetwork().file();
    file.replace(file.find(from), from.size(), to);
    return file;
  };
  expectRefused(replaced("weights", "heights"), "weights of no tensor");
  expectRefused(replaced("image", "imago"), "input of nothing");
  const auto relu = [](const std::string& from, const std::string& to) {
    return Message().bytes(1, from).bytes(2, to).bytes(4, "Relu");
  };
  const Message input = floatValue("image", {1, 3, 6, 8});
  const Message first = relu("image", "a"), second = relu("a", "b");
  EXPECT_NO_THROW(check(
      onnxModel(Message().message(11, input).message(1, first).message(1, second))));
  expectRefused(
      onnxModel(Message().message(11, input).message(1, second).message(1, first)),
      "node before its input");
  expectRefused(onnxModel(Message().message(11, input).message(1, relu("b", "b"))),
                "loop");
}

TEST(OnnxCheck, RefusesSizesThatOpenCvWouldDivideBy)
{
  const auto model = [](const std::string& name, std::uint64_t value) {
    const Message attribute = Message().bytes(1, name).number(3, value).number(20, 2);
    const Message node = Message()
                             .bytes(1, "image")
                             .bytes(2, "out")
                             .bytes(4, "MaxPool")
                             .message(5, attribute);
    return onnxModel(
        Message().message(11, floatValue("image", {1, 3, 6, 8})).message(1, node));
  };
  EXPECT_NO_THROW(check(model("axis", 0)));
  for (const char* name : {"group", "kernel_shape", "strides", "dilations"}) {
    EXPECT_NO_THROW(check(model(name, 1)));
    expectRefused(model(name, 0), name);
    expectRefused(model(name, std::uint64_t(-1)), name);
    expectRefused(model(name, std::uint64_t(1) << 32), name);
  }
}

// Each ended the program: a signal within OpenCV 4.6.
TEST(OnnxCheck, RefusesOperandsThatOpenCvTakesForGranted)
{
  expectRefused(withWeights(floatTensor("weights", {0, 3, 1, 1}, {})),
                "a Conv of no channels");
  const auto withNode = [](const Message& node) {
    return onnxModel(Message()
                         .message(1, node)
                         .bytes(2, "graph")
                         .message(5, floatTensor("none", {0}, {}))
                         .message(11, floatValue("image", {1, 3, 6, 8}))
                         .message(12, floatValue("logits", {1, 3, 6, 8})));
  };
  const auto node = [](const std::string& operation) {
    return Message().bytes(1, "image").bytes(2, "logits").bytes(4, operation);
  };
  for (const char* const operation : {"Pow", "CumSum", "Gemm"}) {
    expectRefused(withNode(node(operation)), operation);
    expectRefused(withNode(node(operation).bytes(1, "none")), operation);
  }
  EXPECT_NO_THROW(check(withNode(node("Resize").bytes(1, "none")))) << "an empty roi";
  const Message value =
      Message().bytes(1, "value").message(5, floatTensor("", {0}, {})).number(20, 4);
  expectRefused(withNode(node("ConstantOfShape").message(5, value)),
                "ConstantOfShape of nothing");
  EXPECT_NO_THROW(check(withNode(node("Constant").message(5, value))));
}

TEST(OnnxCheck, RefusesRandomBytes)
{
  std::mt19937 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string file(1 + random() % 300, '\0');
    for (char& byte : file)
      byte = static_cast<char>(random());
    expectRefused(file, "random bytes");
  }
}

TEST(OnnxCheck, RefusesEveryTruncation)
{
  const std::string file = makeNetwork().file();
  for (std::size_t size = 0; size < file.size(); ++size)
    expectRefused(file.substr(0, size), "cut off at " + std::to_string(size));
}

} // namespace
} // namespace pcl_semantic
