// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/huge_png.h"
#include "support/onnx_writer.h"
#include "support/tiny_street.h"

#include <pcl_semantic/images/image_file.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

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
    write(street + "/net.yaml",
          "model: net.onnx\nlabel_set: " PCL_SEMANTIC_SOURCE_DIR
          "/data/label_sets/kitti11.yaml\ninput: {name: image, width: 8, height: 6}\n"
          "output: {name: logits, softmax: true}\nmean: [0.5, 0.5, 0.5]\n"
          "deviation: [0.2, 0.2, 0.2]\nchannels: [road, car, sky, '-']\n");
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
      {"no calibration", 3, "calib.txt: cannot be read", options, remove("calib.txt")},
      {"tiny focal length", 3, "calib.txt: the camera has a parameter", options,
       [](const std::string& street) {
         for (const auto& [line, number] : {std::pair(3, 2), {3, 7}, {4, 2}, {4, 7}})
           setWord(street + "/calib.txt", std::size_t(line), number, "1e-300");
       }},
      {"of other images", 3, "calib.txt: the principal point (1000, ", options,
       [](const std::string& street) {
         for (const std::size_t line : {3, 4})
           setWord(street + "/calib.txt", line, 4, "1000");
       }},
      {"another size", 3, "image_2/000001.png: has 200 x 64 pixels, expected 208 x 64",
       options,
       [&](const std::string& street) {
         for (const char* const side : {"/image_2", "/image_3"})
           writePng(street + side + "/000001.png", other);
       }},
      {"poses missing", 3, "street: has no poses.txt", options + " --poses sequence",
       remove("poses.txt")},
      {"far pose", 3, "frame 1: the sensor is at", options,
       [](const std::string& street) {
         setWord(street + "/poses.txt", 2, 12, "1e30");
       }},
      {"a pose too few", 3, "poses.txt: has 2 poses, none for frame 2", options,
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
      {"no folder", 3, "labels: is no folder", options, remove("labels")},
      {"a frame missing", 3, "labels: frame 2 has no labels", options,
       remove("labels/000002.bin")},
      {"short", 3, "labels/000002.bin: has 9 bytes", options,
       [](const std::string& street) {
         fs::resize_file(street + "/labels/000002.bin", 9);
       }},
      {"no label set", 3, "none.yaml: cannot be read",
       options + " --label-set TEMP/none.yaml"},
  });
}

// Sizes are compared before anything is decoded.
TEST(BadInput, ImagesThatUnpackToGigabytes)
{
  const std::string calibrate =
      "calibrate STREET --output OUT --labels '{sequence}/labels' --truth "
      "'{sequence}/gt'";
  const std::string evaluate =
      "evaluate --label-set " PCL_SEMANTIC_SOURCE_DIR
      "/data/label_sets/kitti11.yaml --prediction STREET/gt --truth STREET/";
  const auto huge = [](const std::string& name) {
    return [=](const std::string& street) { writeHugePng(street + "/" + name); };
  };
  const std::string says = "has 30000 x 30000 pixels, expected 208 x 64";
  expectAllFail({
      {"image", 3, "000001.png: " + says, "--labels STREET/labels",
       huge("image_2/000001.png")},
      {"labels", 3, "000001.png: " + says, "--labels STREET/gt", huge("gt/000001.png")},
      {"calibrate", 3, "000001.png: " + says, calibrate, huge("gt/000001.png")},
      {"prediction", 3, "000001.png: " + says, evaluate + "other",
       [&](const std::string& street) {
         fs::copy(street + "/gt", street + "/other");
         huge("gt/000001.png")(street);
       }},
      {"truth", 3, "gt/000001.png: has 208 x 64 pixels, expected 30000 x 30000",
       evaluate + "other",
       [&](const std::string& street) {
         fs::copy(street + "/gt", street + "/other");
         huge("other/000001.png")(street);
       }},
      {"cover", 3, "000001.png: " + says, evaluate + "gt --covered-by STREET/other",
       [&](const std::string& street) {
         fs::copy(street + "/gt", street + "/other");
         huge("other/000001.png")(street);
       }},
      {"depth", 3, "000001.png: has 30000 x 30000 depths, the ground truth 208 x 64",
       evaluate + "gt --range 0:9 --truth-depth STREET/disparity",
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
      {"poses", 3, "poses.txt: ", labels, loop("poses.txt")},
      {"times", 3, "times.txt: ", labels, loop("times.txt")},
      {"images", 3, "image_2", labels, loop("image_2")},
      {"labels", 3, "labels: is no folder", labels, loop("labels")},
      {"prediction", 3, "000001.png: ",
       "evaluate --label-set " PCL_SEMANTIC_SOURCE_DIR
       "/data/label_sets/kitti11.yaml --prediction STREET/labels --truth STREET/gt",
       [&](const std::string& street) {
         fs::copy(street + "/gt/000000.png", street + "/labels/000000.png");
         loop("labels/000001.png")(street);
       }},
      {"pairs", 2, "LEFT and RIGHT have to be two images, or two folders",
       "stereo STREET/image_2 STREET/image_3 STREET/calib.txt OUT", loop("image_2")},
      {"scan", 3, "velodyne/000000.bin: ", labels + " --also scans --frames 0:1",
       [&](const std::string& street) {
         addScan(street);
         loop("velodyne/000000.bin")(street);
       }},
      {"rgbd", 3, "has neither rgb.txt nor a folder 'rgb'",
       "map --rgbd STREET --calibration STREET/calib.txt --poses STREET/poses.txt "
       "--output OUT " +
           labels,
       loop("rgb")},
      {"cliques", 3, "cliques.txt: ",
       "crf STREET/a.pcd TEMP/o.pcd --crf pn-potts --cliques STREET/cliques.txt",
       [&](const std::string& street) {
         std::ofstream(street + "/a.pcd")
             << "VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\n"
                "COUNT 1 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 1 1\n";
         loop("cliques.txt")(street);
       }},
  });
}

TEST(BadInput, Networks)
{
  const std::string options = "--network STREET/net.yaml --crf none --frames 0:1";
  expectAllFail({
      {"no description", 3, "net.yaml: cannot be read", options},
      {"no network", 4, "net.onnx: ", options, network(4, "no network")},
      {"missing", 3, "none.onnx: cannot be read", options + " --model STREET/none.onnx",
       network(4)},
      {"channels", 4, "frame 0: ", options, network(5)},
      // OpenCV 4.6 ends the program that loads this one.
      {"deadly", 4, "the network ", options + " --engine opencv",
       network(4, argumentOfConstant())},
  });
}

} // namespace pcl_semantic
