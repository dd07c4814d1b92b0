// SPDX-License-Identifier: BSD-3-Clause
#include "camera_file.h"

#include "core/fail.h"
#include "core/split.h"

#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>

namespace pcl_semantic {

namespace {

using Keys = CalibrationSource::Keys;

const Keys matrix_keys = {"camera_matrix", "K", "k", "cameraMatrix", "Camera_Matrix"};
const Keys distortion_keys = {"distortion_coefficients",
                              "D",
                              "d",
                              "distCoeffs",
                              "dist_coeffs",
                              "distortion_coeffs",
                              "Distortion_Coefficients"};
const Keys rectification_keys = {"rectification_matrix", "R", "r"};
const Keys projection_keys = {"projection_matrix", "P", "p"};

// Columns, then rows; 0 = not stated.
using Size = std::pair<int, int>;

std::string
textOf(const Size& size)
{
  return std::to_string(size.first) + " x " + std::to_string(size.second);
}

// Binning and region of interest of sensor_msgs/CameraInfo.
struct Window {
  int columns = 1, rows = 1;               // sensor pixels per image pixel
  int x = 0, y = 0, width = 0, height = 0; // on the sensor; width 0 = all

  Window() = default;

  explicit Window(const CalibrationSource& source)
      : columns(std::max(1, source.count("binning_x"))),
        rows(std::max(1, source.count("binning_y")))
  {
    if (!source.map.isMap("roi"))
      return;
    const CalibrationSource roi = source.inner("roi");
    x = roi.count("x_offset");
    y = roi.count("y_offset");
    width = roi.count("width");
    height = roi.count("height");
    if ((width == 0) != (height == 0) || (width == 0 && (x > 0 || y > 0)))
      badInput(source.where("roi"), ": has ", textOf({width, height}),
               " pixels, expected more, or zeros for the whole image");
  }

  // Size of the images. `text` receives its derivation.
  Size
  apply(const Size& sensor, const std::string& where, std::string& text) const
  {
    if (sensor.first > 0 && (x + width > sensor.first || y + height > sensor.second))
      badInput(where, ": the region of interest, ", textOf({width, height}), " at ", x,
               ", ", y, ", is not inside ", textOf(sensor), " pixels");
    const bool is_cropped = width > 0 && Size(width, height) != sensor;
    const Size cropped = width > 0 ? Size(width, height) : sensor;
    const Size size(cropped.first / columns, cropped.second / rows);
    text = textOf(size);
    if (size == sensor)
      return size;
    text += " (";
    text += sensor.first > 0 ? textOf(sensor) : std::string("a sensor");
    if (is_cropped)
      text += ", region of interest " + textOf(cropped) + " at " + std::to_string(x) +
              ", " + std::to_string(y);
    if (columns > 1 || rows > 1)
      text += ", binning " + textOf({columns, rows});
    text += ")";
    return size;
  }

  // Applied to K or P, as in image_geometry::PinholeCameraModel.
  template <typename Matrix>
  void
  apply(Matrix& matrix) const
  {
    matrix.col(2).template head<2>() -= Eigen::Vector2d(x, y);
    matrix.row(0) /= columns;
    matrix.row(1) /= rows;
  }
};

Eigen::Matrix3d
matrixOf(const std::vector<double>& values, const std::string& where)
{
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
  if (values.size() == 9)
    K = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
  requireCameraMatrix(K, where);
  return K;
}

// Kalibr and EuRoC: fx fy cx cy.
void
readIntrinsics(const CalibrationSource& source, CameraFile& camera)
{
  std::string kind;
  if (source.map.get("sensor_type", kind) && kind != "camera")
    badInput(source.where("sensor_type"), " is ", inQuotes(kind),
             ", expected a 'camera'");
  source.requireModel("camera_model", {"pinhole"});
  camera.is_fisheye =
      readsFisheye(source, {"radtan", "radial-tangential", "plumb_bob", "none"});
  const std::vector<double> values = source.numbers({"intrinsics"});
  if (values.size() != 4)
    badInput(source.where("intrinsics"), ": has ", values.size(),
             " numbers, expected fx, fy, cx, cy");
  camera.K << values[0], 0, values[2], 0, values[1], values[3], 0, 0, 1;
  if (source.map.has("T_BS")) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T(
        source.numbers({"T_BS"}, 16).data());
    if (T.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
      badInput(source.where("T_BS"), ": its last row is not 0 0 0 1");
    camera.T_body_camera = Eigen::Isometry3d::Identity();
    camera.T_body_camera->linear() =
        nearestRotation(T.topLeftCorner<3, 3>(), source.where("T_BS"), camera.doubts);
    camera.T_body_camera->translation() = T.topRightCorner<3, 1>();
  }
}

// ROS and OpenCV.
void
readMatrices(const CalibrationSource& source, CameraFile& camera)
{
  camera.is_fisheye =
      readsFisheye(source, {"plumb_bob", "rational_polynomial", "none", ""});
  const std::string key = source.find(matrix_keys);
  camera.K = matrixOf(source.numbers({key}), source.where(key));
  const std::string projection = source.find(projection_keys);
  if (!projection.empty()) {
    camera.P = RowMajor34(source.numbers({projection}, 12).data());
    if (camera.P->isZero(0.0)) // from drivers without calibration
      camera.P.reset();
    else
      requireCameraMatrix(camera.P->leftCols<3>(), source.where(projection));
  }
  const std::string rectification = source.find(rectification_keys);
  if (rectification.empty())
    return;
  const Eigen::Matrix3d R = source.square({rectification});
  if (!R.isZero(0.0)) // zero without a calibration, like P
    camera.R = nearestRotation(R, source.where(rectification), camera.doubts);
}

void
readDistortion(const CalibrationSource& source, CameraFile& camera)
{
  camera.D.assign(4, 0.0);
  const std::string key = source.find(distortion_keys);
  if (key.empty() && camera.is_fisheye)
    badInput(source.path, ": states no distortion coefficients, expected the 4 of an "
                          "equidistant fisheye");
  if (key.empty())
    return;
  camera.distortion = source.where(key);
  const std::vector<double> D = source.numbers({key});
  if (camera.is_fisheye && D.size() != 4)
    badInput(camera.distortion, ": has ", D.size(),
             " numbers, expected the 4 of an equidistant fisheye");
  if (!D.empty())
    camera.D = D;
}

// "cam0=[f 0 cx; 0 f cy; 0 0 1]"
CameraFile
middleburyCamera(const std::string& path, const std::string& text,
                 const std::string& where)
{
  std::string words = text;
  for (char& letter : words)
    if (letter == '[' || letter == ']' || letter == ';' || letter == ',')
      letter = ' ';
  CameraFile camera;
  camera.path = path;
  camera.K = matrixOf(parseNumbers(words, where), where);
  camera.D.assign(4, 0.0);
  return camera;
}

// Camera 2, the left colour camera.
CameraFile
readKittiCamera(const std::string& path)
{
  const StereoCamera stereo = readKittiCalibration(path, KittiCameras::colour).camera;
  CameraFile camera;
  camera.path = path;
  camera.K << stereo.fx, 0, stereo.cx, 0, stereo.fy, stereo.cy, 0, 0, 1;
  camera.D.assign(4, 0.0);
  camera.width = stereo.width;
  camera.height = stereo.height;
  camera.size = textOf({stereo.width, stereo.height});
  return camera;
}

// One line with fx fy cx cy, as ETH3D's calibration.txt; nothing for another file.
std::optional<CameraFile>
readIntrinsicsLine(const std::string& path)
{
  std::vector<TextLine> lines = readLines(path);
  lines.erase(std::remove_if(lines.begin(), lines.end(),
                             [](const TextLine& line) {
                               return line.text.empty() || line.text[0] == '#';
                             }),
              lines.end());
  if (lines.size() != 1 || wordsOf(lines[0].text).size() != 4)
    return std::nullopt;
  const std::vector<double> values =
      parseNumbers(lines[0].text, atLine(path, lines[0].number));
  CameraFile camera;
  camera.path = path;
  camera.K << values[0], 0, values[2], 0, values[1], values[3], 0, 0, 1;
  camera.D.assign(4, 0.0);
  return camera;
}

void
doubtOtherCameras(const YamlMap& file, CameraFile& camera)
{
  std::string others;
  for (const std::string& key : file.keys())
    if (key != "cam0" && key.rfind("cam", 0) == 0 && file.isMap(key))
      others += (others.empty() ? "" : ", ") + key;
  if (!others.empty())
    camera.doubts.push_back(file.where("cam0") + ": cam0 is used, not " + others +
                            ": are these its images?");
}

} // namespace

bool
readsFisheye(const CalibrationSource& source,
             const CalibrationSource::Keys& pinhole_models)
{
  std::string model;
  const bool has_model = source.map.get("distortion_model", model) && !model.empty();
  const bool is_equidistant = model == "equidistant" || model == "fisheye";
  Keys models = pinhole_models;
  models.push_back("equidistant");
  if (!is_equidistant)
    source.requireModel("distortion_model", models);
  if (!source.map.has("fisheye_model"))
    return is_equidistant;
  const int is_fisheye = source.count("fisheye_model");
  if (is_fisheye > 1)
    badInput(source.where("fisheye_model"), " is ", is_fisheye, ", expected 0 or 1");
  if (has_model && is_equidistant != (is_fisheye == 1))
    badInput(source.where("fisheye_model"), " is ", is_fisheye,
             ", but distortion_model is ", inQuotes(model));
  return is_fisheye == 1;
}

bool
CameraFile::isDistorted() const
{
  return is_fisheye ||
         std::any_of(D.begin(), D.end(), [](double d) { return d != 0.0; });
}

bool
CameraFile::isRectified() const
{
  return !isDistorted() && P && P->leftCols<3>() != K;
}

void
requireCameraMatrix(const Eigen::Matrix3d& K, const std::string& where)
{
  if (K(0, 1) != 0.0 || K(1, 0) != 0.0 || K.row(2) != Eigen::RowVector3d(0, 0, 1))
    badInput(where, ": is no camera matrix, expected fx 0 cx 0 fy cy 0 0 1");
}

void
requireStatedSize(int width, int height, const std::string& stated,
                  const std::string& calibration, int image_width, int image_height,
                  const std::string& image)
{
  if (width > 0 && Size(width, height) != Size(image_width, image_height))
    badInput(image, ": has ", image_width, " x ", image_height, " pixels, but ",
             calibration, " is the calibration of ",
             stated.empty() ? textOf({width, height}) : stated);
}

std::pair<int, int>
readCameraSize(const CalibrationSource& source)
{
  std::vector<std::pair<std::string, Size>> found;
  for (const auto& [width, height] :
       {std::pair("image_width", "image_height"), std::pair("width", "height")}) {
    Size size;
    const bool has_width = source.map.get(width, size.first);
    if (has_width != source.map.get(height, size.second))
      badInput(source.path, ": expected both '", width, "' and '", height, "'");
    if (has_width)
      found.emplace_back(width, size);
  }
  for (const char* const key : {"image_size", "imageSize", "resolution"})
    if (source.map.has(key)) {
      const auto size = source.map.require<std::vector<int>>(key);
      if (size.size() != 2)
        badInput(source.where(key), ": has ", size.size(),
                 " numbers, expected width, height");
      found.emplace_back(key, Size(size[0], size[1]));
    }
  for (const auto& [key, size] : found) {
    if (size != found.front().second)
      badInput(source.where(key), ": the image size is ", textOf(size), ", but '",
               found.front().first, "' says ", textOf(found.front().second));
    // Drivers without a calibration write zeros.
    if (size != Size(0, 0) && (size.first < 2 || size.second < 2))
      badInput(source.path, ": the image size is ", textOf(size),
               " pixels, expected 2 x 2 or more");
  }
  return found.empty() ? Size(0, 0) : found.front().second;
}

int
wholePixels(double number, const std::string& where)
{
  if (!(number >= 2.0 && number <= 1e6 && number == std::floor(number)))
    badInput(where, ": is ", number, ", expected 2 to 1e6 pixels");
  return int(number);
}

bool
isYamlCamera(const CalibrationSource& source)
{
  return source.map.has("intrinsics") || !source.find(matrix_keys).empty();
}

CameraFile
readYamlCamera(const CalibrationSource& source)
{
  CameraFile camera;
  camera.path = source.path;
  if (source.map.has("intrinsics"))
    readIntrinsics(source, camera);
  else
    readMatrices(source, camera);
  readDistortion(source, camera);
  const Window window(source);
  std::tie(camera.width, camera.height) =
      window.apply(readCameraSize(source), source.where("roi"), camera.size);
  camera.is_cropped = window.width > 0;
  window.apply(camera.K);
  if (camera.P)
    window.apply(*camera.P);
  return camera;
}

bool
isMiddlebury(const std::string& path)
{
  if (std::filesystem::path(path).extension() != ".txt")
    return false;
  const std::vector<TextLine> lines = readLines(path);
  return !lines.empty() && lines.front().text.rfind("cam0=", 0) == 0;
}

MiddleburyFile
readMiddlebury(const std::string& path)
{
  std::map<std::string, TextLine> values;
  for (const TextLine& line : readLines(path))
    if (const std::size_t equals = line.text.find('='); equals != std::string::npos)
      values[line.text.substr(0, equals)] = {line.text.substr(equals + 1), line.number};
  const auto find = [&](const std::string& name) {
    const auto found = values.find(name);
    if (found == values.end())
      badInput(path, ": has no line '", name, "=', expected Middlebury's calib.txt");
    return std::pair(found->second.text,
                     atLine(path, found->second.number) + ": " + name);
  };
  const auto number = [&](const std::string& name) {
    const auto [text, where] = find(name);
    return parseNumber(text, where);
  };
  MiddleburyFile file;
  file.left = middleburyCamera(path, find("cam0").first, find("cam0").second);
  file.right = middleburyCamera(path, find("cam1").first, find("cam1").second);
  file.baseline = 1e-3 * number("baseline");
  for (CameraFile* const camera : {&file.left, &file.right}) {
    camera->width = wholePixels(number("width"), find("width").second);
    camera->height = wholePixels(number("height"), find("height").second);
    camera->size = textOf({camera->width, camera->height});
  }
  return file;
}

CameraFile
readCameraFile(const std::string& path)
{
  if (isMiddlebury(path))
    return readMiddlebury(path).left;
  if (std::filesystem::path(path).extension() == ".txt") {
    const std::optional<CameraFile> line = readIntrinsicsLine(path);
    return line ? *line : readKittiCamera(path);
  }
  const CalibrationSource file = CalibrationSource::load(path);
  if (file.map.isMap("cam0")) {
    CameraFile camera = readYamlCamera(file.inner("cam0"));
    doubtOtherCameras(file.map, camera);
    return camera;
  }
  if (isYamlCamera(file))
    return readYamlCamera(file);
  const std::string pair = file.find({"K1", "M1", "cameraMatrix1", "camera_matrix_1"});
  if (!pair.empty())
    badInput(file.where(pair), ": is the calibration of a pair, expected that of one "
                               "camera, with its matrix as 'camera_matrix'");
  badInput(path, ": has neither camera_matrix or K (ROS' camera_info, OpenCV), cam0 "
                 "(Kalibr) nor intrinsics (EuRoC); KITTI's and Middlebury's calib.txt "
                 "are read, too");
}

} // namespace pcl_semantic
