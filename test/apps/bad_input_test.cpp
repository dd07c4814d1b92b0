// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/onnx_writer.h"
#include "support/tiny_street.h"

#include <pcl_semantic/files/image_file.h>

#include <opencv2/imgcodecs.hpp>

#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

void
write(const std::string& path, const std::string& bytes)
{
  std::ofstream(path, std::ios::binary) << bytes;
}

// Cuts a file, or makes it longer.
BadCase::Damage
resize(const std::string& name, int by)
{
  return [=](const std::string& street) {
    const std::string path = street + "/" + name;
    const auto size = static_cast<std::intmax_t>(fs::file_size(path));
    fs::resize_file(path, static_cast<std::uintmax_t>(size + by));
  };
}

BadCase::Damage
empty(const std::string& name)
{
  return [=](const std::string& street) { fs::resize_file(street + "/" + name, 0); };
}

BadCase::Damage
remove(const std::string& name)
{
  return [=](const std::string& street) { fs::remove_all(street + "/" + name); };
}

BadCase::Damage
word(const std::string& name, std::size_t line, int word, const std::string& text)
{
  return [=](const std::string& street) {
    setWord(street + "/" + name, line, word, text);
  };
}

BadCase::Damage
image(const std::string& name, const cv::Mat& image)
{
  return [=](const std::string& street) { writePng(street + "/" + name, image); };
}

// The first number of a .bin becomes another.
BadCase::Damage
probability(float value)
{
  return [=](const std::string& street) {
    std::fstream stream(street + "/labels/000001.bin",
                        std::ios::binary | std::ios::in | std::ios::out);
    stream.write(reinterpret_cast<const char*>(&value), sizeof(value));
  };
}

// Stored labels of frame 1 in another form.
BadCase::Damage
labels(const std::string& extension, const std::string& bytes)
{
  return [=](const std::string& street) {
    fs::remove(street + "/labels/000001.bin");
    write(street + "/labels/000001" + extension, bytes);
  };
}

std::string
encoded(const std::string& extension, const cv::Mat& picture)
{
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

// A network of \a channels beside the street, in a file of \a bytes if they are given.
BadCase::Damage
network(int channels, const std::string* bytes = nullptr)
{
  PointwiseNetwork net;
  net.channels = channels;
  net.weights.resize(3 * std::size_t(channels), 0.5f);
  net.bias.resize(std::size_t(channels), 0.1f);
  return [=, file = bytes ? *bytes : net.file()](const std::string& street) {
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

BadCase::Damage
network(const std::string& bytes)
{
  return network(4, &bytes);
}

} // namespace

TEST(BadInput, Sequence)
{
  const std::string options = "--labels STREET/labels --crf none";
  expectAllFail({
      {"no sequence", 3, "street: is no folder", options, remove("")},
      {"no calibration", 3, "calib.txt: cannot be read", options, remove("calib.txt")},
      {"11 numbers", 3, "calib.txt line 3: P2: has 11", options,
       word("calib.txt", 3, 6, "")},
      {"NaN in calibration", 3, "calib.txt line 4: P3: 'nan'", options,
       word("calib.txt", 4, 5, "nan")},
      {"decimal comma", 3, "calib.txt line 4: P3: '1,5'", options,
       word("calib.txt", 4, 5, "1,5")},
      {"baseline", 3, "calib.txt line 4: P3: baseline is -", options,
       word("calib.txt", 4, 5, "60")},
      {"focal length", 3, "calib.txt line 3: P2: focal", options,
       word("calib.txt", 3, 2, "0")},
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
      {"no right image", 3, "image_3/000001.png: is missing", options,
       remove("image_3/000001.png")},
      {"no left image", 3, "image_2/000002.png: is missing", options,
       remove("image_2/000002.png")},
      {"poses missing", 3, "street: has no poses.txt", options + " --poses sequence",
       remove("poses.txt")},
      {"NaN pose", 3, "poses.txt line 2: 'nan'", options,
       word("poses.txt", 2, 1, "nan")},
      {"pose of 11", 3, "poses.txt line 3: has 11", options,
       word("poses.txt", 3, 12, "")},
      {"no rotation", 3, "poses.txt line 2: the left 3 x 3 block is no rotation",
       options, word("poses.txt", 2, 1, "2")},
      {"far pose", 3, "frame 1: the sensor is at", options,
       word("poses.txt", 2, 12, "1e30")},
      {"a pose too few", 3,
       "poses.txt: has 2 poses, none for frame 2 (row = frame number); 1 of 3 "
       "frames lack one",
       options,
       [](const std::string& street) {
         const std::vector<std::string> lines = linesOf(street + "/poses.txt");
         write(street + "/poses.txt", lines[0] + "\n" + lines[1] + "\n");
       }},
  });
}

TEST(BadInput, Images)
{
  const cv::Mat colour(64, 208, CV_8UC3, cv::Scalar(90, 80, 70));
  const std::string options = "--labels STREET/labels --crf none --frames 1:3";
  const std::string left = "image_2/000001.png", right = "image_3/000001.png";
  const auto jpeg = [=](const std::string& street) {
    write(street + "/" + left, encoded(".jpg", colour));
  };
  expectAllFail({
      {"truncated", 3, left + ": the PNG image is damaged", options, resize(left, -99)},
      {"truncated right", 3, right + ": the PNG image is damaged", options,
       resize(right, -1)},
      {"empty", 3, left + ": is not a PNG image (frame 1)", options, empty(left)},
      {"JPEG", 3, left + ": is not a PNG image (frame 1)", options, jpeg},
      {"16 bit", 3, left + ": has 3 channel(s) of 16 bits", options,
       image(left, cv::Mat(64, 208, CV_16UC3, cv::Scalar::all(999)))},
      {"RGBA", 3, left + ": has 4 channel(s)", options,
       image(left, cv::Mat(64, 208, CV_8UC4, cv::Scalar::all(99)))},
      {"another size", 3, left + ": has 200 x 64 pixels, expected 208 x 64", options,
       [=](const std::string& street) {
         image(left, colour.colRange(0, 200))(street);
         image(right, colour.colRange(0, 200))(street);
       }},
      {"sizes differ", 3, right + ": has 208 x 60 pixels", options,
       image(right, colour.rowRange(0, 60))},
      {"one pixel", 3, "image_2/000000.png: is only 1 x 1", options,
       image("image_2/000000.png", colour(cv::Rect(0, 0, 1, 1)))},
  });
}

TEST(BadInput, StoredLabels)
{
  const std::string options = "--labels STREET/labels --crf none --frames 1:3";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string zeros(208 * 64 * 11 * 4, '\0');
  const cv::Mat1b ids(64, 208, std::uint8_t(12));
  expectAllFail({
      {"no folder", 3, "labels: is no folder", options, remove("labels")},
      {"a frame missing", 3, "labels: frame 1 has no labels", options,
       remove("labels/000001.bin")},
      {"short", 3, "labels/000001.bin: has 585727 bytes", options,
       resize("labels/000001.bin", -1)},
      {"long", 3, "labels/000001.bin: has 585729 bytes", options,
       resize("labels/000001.bin", 1)},
      {"NaN", 3, "labels/000001.bin: pixel (0, 0)", options, probability(nan)},
      {"negative", 3, "labels/000001.bin: pixel (0, 0)", options, probability(-0.5f)},
      {"sum", 3, "labels/000001.bin: pixel (0, 0)", options, probability(200.0f)},
      {"double", 3, "labels/000001.npy: has type '<f8'", options,
       labels(".npy", npyBytes("<f8", "(64, 208, 11)", zeros + zeros))},
      {"shape", 3, "labels/000001.npy: has shape (208, 64, 11)", options,
       labels(".npy", npyBytes("<f4", "(208, 64, 11)", zeros))},
      {"short npy", 3, "labels/000001.npy: has", options,
       labels(".npy", npyBytes("<f4", "(64, 208, 11)", zeros.substr(4)))},
      {"no npy", 3, "labels/000001.npy: is not a NumPy file", options,
       labels(".npy", zeros)},
      {"id", 3, "labels/000001.png: pixel (0, 0) has class 12", options,
       labels(".png", encoded(".png", ids))},
      {"no png", 3, "labels/000001.png: is not a PNG", options, labels(".png", "")},
      {"two files", 3, "labels: frame 1 has two files of labels", options,
       [&](const std::string& street) {
         write(street + "/labels/000001.png", encoded(".png", ids));
       }},
      {"other classes", 3, "labels/000001.bin: has",
       options + " --label-set " PCL_SEMANTIC_SOURCE_DIR
                 "/data/label_sets/cityscapes19.yaml"},
      {"no label set", 3, "none.yaml: cannot be read",
       options + " --label-set TEMP/none.yaml"},
  });
}

TEST(BadInput, Networks)
{
  const std::string options = "--network STREET/net.yaml --crf none --frames 0:1";
  std::string noise(5000, '\0');
  std::uint32_t state = 1;
  for (char& byte : noise)
    byte = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  PointwiseNetwork net;
  net.weights.resize(12, 0.5f);
  net.bias.resize(4, 0.1f);
  const std::string whole = net.file();
  net.weights.resize(6);
  const std::string short_of_weights = net.file();
  net.weights.resize(12, 0.5f);
  net.bias[0] = std::numeric_limits<float>::quiet_NaN();
  expectAllFail({
      {"no description", 3, "net.yaml: cannot be read", options},
      {"random", 4, "net.onnx: ", options, network(noise)},
      {"empty", 4, "net.onnx: ", options, network("")},
      {"truncated", 4, "net.onnx: ", options,
       network(whole.substr(0, whole.size() / 2))},
      {"missing", 3, "none.onnx: cannot be read", options + " --model STREET/none.onnx",
       network(4)},
      {"channels", 4, "frame 0: ", options, network(5)},
      // OpenCV 4.6 reads on behind them.
      {"short", 4, "'weights' has 6 elements, its dimensions state 12", options,
       network(short_of_weights)},
      {"NaN", 4, "frame 0: ", options, network(net.file())},
      // OpenCV 4.6 ends the program that loads this one.
      {"deadly", 4, "the network ", options + " --engine opencv",
       network(argumentOfConstant())},
  });
}

} // namespace pcl_semantic
