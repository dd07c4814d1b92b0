// SPDX-License-Identifier: BSD-3-Clause
#include "labelling/onnx_interface.h"
#include "support/onnx_writer.h"
#include "support/refusal.h"

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

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

TEST(OnnxInterface, RefusesWeightsInAnotherFile)
{
  const Message elsewhere =
      floatTensor("weights", {1}, {}).bytes(13, "location: weights.bin");
  const std::string message = thrownMessage<BadModelException>([&] {
    read(onnxModel(Message()
                       .message(1, Message().bytes(1, "a").bytes(2, "b"))
                       .message(5, elsewhere)));
  });
  EXPECT_TRUE(holds(message, "weights 'weights' lie in another file")) << message;
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

TEST(OnnxInterface, RefusesRandomBytes)
{
  std::mt19937 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string file(1 + random() % 300, '\0');
    for (char& byte : file)
      byte = static_cast<char>(random());
    expectRefused(file, "random bytes");
  }
}

TEST(OnnxInterface, RefusesEveryTruncation)
{
  const std::string file = makeNetwork().file();
  for (std::size_t size = 0; size < file.size(); ++size)
    expectRefused(file.substr(0, size), "cut off at " + std::to_string(size));
}

} // namespace
} // namespace pcl_semantic
