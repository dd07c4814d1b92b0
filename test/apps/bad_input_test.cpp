// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/onnx_writer.h"
#include "support/tiny_street.h"

#include <pcl_semantic/images/image_file.h>

#include <boost/crc.hpp>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// A number as four big-endian bytes, as in PNG.
std::string
bigEndian(std::uint32_t number)
{
  std::string bytes;
  for (const int shift : {24, 16, 8, 0})
    bytes += char(number >> shift);
  return bytes;
}

// Writes a PNG whose header states 30000 x 30000 grey pixels, with 100 kB of invalid
// data. A decoder reports damage.
void
writeHugePng(const std::string& path)
{
  std::string file = "\x89PNG\r\n\x1A\n";
  const auto add = [&](const std::string& name, const std::string& data) {
    boost::crc_32_type crc;
    crc.process_bytes((name + data).data(), name.size() + data.size());
    file +=
        bigEndian(std::uint32_t(data.size())) + name + data + bigEndian(crc.checksum());
  };
  const std::string grey("\x08\0\0\0\0", 5);
  add("IHDR", bigEndian(30000) + bigEndian(30000) + grey);
  add("IDAT", std::string(100000, '\0'));
  add("IEND", "");
  std::ofstream(path, std::ios::binary) << file;
}

void
write(const std::string& path, const std::string& bytes)
{
  std::ofstream(path, std::ios::binary) << bytes;
}

BadCase::Damage
remove(const std::string& name)
{
  return [=](const std::string& street) { fs::remove_all(street + "/" + name); };
}

const std::string evaluate = "evaluate" + of_kitti11 + "--prediction STREET/";

// A network of \a channels beside the street, in a file of \a bytes if they are given.
BadCase::Damage
network(int channels, const std::string& bytes = "")
{
  PointwiseNetwork net;
  net.channels = channels;
  net.weights.resize(3 * std::size_t(channels), 0.5f);
  net.bias.resize(std::size_t(channels), 0.1f);
  return [=, file = bytes.empty() ? net.file() : bytes](const std::string& street) {
    write(street + "/net.onnx", file);
    write(street + "/net.yaml", smallNetworkYaml("net.onnx", "road, car, sky, '-'"));
  };
}

// ArgMax where nothing depends on the image.
std::string
argumentOfConstant()
{
  const auto node = [](const char* type, const char* from, const char* to) {
    return Message().bytes(1, from).bytes(2, to).bytes(3, type).bytes(4, type);
  };
  return onnxModel(Message()
                       .message(1, node("ArgMax", "constant", "inner"))
                       .message(1, node("Identity", "inner", "logits"))
                       .bytes(2, "graph")
                       .message(5, floatTensor("constant", {2}, {1.0f, 2.0f}))
                       .message(11, floatValue("image", {1, 3, 6, 8}))
                       .message(12, floatValue("logits", {1, 4, 6, 8})));
}

} // namespace

// The readers' tests cover the faults of files; these tests cover the programs'
// messages.
TEST(BadInput, Sequence)
{
  const std::string options = "--labels STREET/labels --crf none";
  const cv::Mat other(64, 200, CV_8UC3, cv::Scalar(90, 80, 70));
  expectAllFail({
      {3, "calib.txt: cannot be read", options, remove("calib.txt")},
      {3, "calib.txt: the camera has a parameter", options,
       [](const std::string& street) {
         for (const auto& [line, number] : {std::pair(3, 2), {3, 7}, {4, 2}, {4, 7}})
           setWord(street + "/calib.txt", std::size_t(line), number, "1e-300");
       }},
      {3, "calib.txt: the principal point (1000, ", options,
       [](const std::string& street) {
         for (const std::size_t line : {3, 4})
           setWord(street + "/calib.txt", line, 4, "1000");
       }},
      {3, "image_2/000001.png: has 200 x 64 pixels, expected 208 x 64", options,
       [&](const std::string& street) {
         for (const char* const side : {"/image_2", "/image_3"})
           writePng(street + side + "/000001.png", other);
       }},
      {3, "street: has no poses.txt", options + " --poses sequence",
       remove("poses.txt")},
      {3, "frame 1: the sensor is at", options,
       [](const std::string& street) {
         setWord(street + "/poses.txt", 2, 12, "1e30");
       }},
      {3, "poses.txt: has 2 poses, none for frame 2", options,
       [](const std::string& street) {
         const std::vector<std::string> lines = linesOf(street + "/poses.txt");
         write(street + "/poses.txt", lines[0] + "\n" + lines[1] + "\n");
       }},
  });
}

TEST(BadInput, StoredLabels)
{
  const std::string options = "--labels STREET/labels --crf none --frames 1:3";
  expectAllFail({
      {3, "labels: is no folder", options, remove("labels")},
      {3, "labels: frame 2 has no labels", options, remove("labels/000002.bin")},
      {3, "labels/000002.bin: has 9 bytes", options,
       [](const std::string& street) {
         fs::resize_file(street + "/labels/000002.bin", 9);
       }},
      {3, "none.yaml: cannot be read", options + " --label-set TEMP/none.yaml"},
  });
}

// Sizes are compared before anything is decoded.
TEST(BadInput, ImagesThatUnpackToGigabytes)
{
  const auto huge = [](const std::string& name) {
    return [=](const std::string& street) { writeHugePng(street + "/" + name); };
  };
  const auto withOther = [](const std::string& name) {
    return [=](const std::string& street) {
      fs::copy(street + "/gt", street + "/other");
      writeHugePng(street + "/" + name);
    };
  };
  const std::string says = "has 30000 x 30000 pixels, expected 208 x 64";
  expectAllFail({
      {3, "000001.png: " + says, "--labels STREET/labels", huge("image_2/000001.png")},
      {3, "000001.png: " + says, "--labels STREET/gt", huge("gt/000001.png")},
      {3, "000001.png: " + says, evaluate + "gt --truth STREET/other",
       withOther("gt/000001.png")},
      {3, "gt/000001.png: has 208 x 64 pixels, expected 30000 x 30000",
       evaluate + "gt --truth STREET/other", withOther("other/000001.png")},
      {3, "000001.png: " + says,
       evaluate + "gt --truth STREET/gt --covered-by STREET/other",
       withOther("other/000001.png")},
      {3, "000001.png: has 30000 x 30000 depths, the ground truth 208 x 64",
       evaluate + "gt --truth STREET/gt --range 0:9 --truth-depth STREET/disparity",
       huge("disparity/000001.png")},
  });
}

// A link to itself is there, but cannot be opened: errors name the path, no function.
TEST(BadInput, LoopsOfLinks)
{
  const auto loop = [](const std::string& name) {
    return [=](const std::string& street) {
      fs::remove_all(street + "/" + name);
      fs::create_symlink(street + "/" + name, street + "/" + name);
    };
  };
  const std::string labels = "--labels STREET/labels";
  expectAllFail({
      {3, "poses.txt: ", labels, loop("poses.txt")},
      {3, "times.txt: ", labels, loop("times.txt")},
      {3, "image_2", labels, loop("image_2")},
      {3, "labels: is no folder", labels, loop("labels")},
      {3, "000001.png: ", evaluate + "labels --truth STREET/gt",
       [&](const std::string& street) {
         fs::copy(street + "/gt/000000.png", street + "/labels/000000.png");
         loop("labels/000001.png")(street);
       }},
      {2, "LEFT and RIGHT have to be two images, or two folders",
       "stereo STREET/image_2 STREET/image_3 STREET/calib.txt OUT", loop("image_2")},
      {3, "velodyne/000000.bin: ", labels + " --also scans --frames 0:1",
       [&](const std::string& street) {
         addScan(street);
         loop("velodyne/000000.bin")(street);
       }},
      {3, "is no RGB-D sequence",
       "map --rgbd STREET --calibration STREET/calib.txt --poses STREET/poses.txt "
       "--output OUT " +
           labels,
       loop("rgb")},
      {3, "cliques.txt: ",
       "crf STREET/a.pcd TEMP/o.pcd --crf pn-potts --cliques STREET/cliques.txt",
       [&](const std::string& street) {
         write(street + "/a.pcd", asciiCloud("x y z label", "0 0 1 1\n"));
         loop("cliques.txt")(street);
       }},
  });
}

TEST(BadInput, Networks)
{
  const std::string options = "--network STREET/net.yaml --crf none --frames 0:1";
  expectAllFail({
      {3, "net.yaml: cannot be read", options},
      {4, "net.onnx: ", options, network(4, "no network")},
      {3, "none.onnx: cannot be read", options + " --model STREET/none.onnx",
       network(4)},
      {4, "frame 0: ", options, network(5)},
      // OpenCV 4.6 ends the program that loads this one.
      {4, "the network ", options + " --engine opencv",
       network(4, argumentOfConstant())},
  });
}

} // namespace pcl_semantic
