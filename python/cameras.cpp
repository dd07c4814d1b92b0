// SPDX-License-Identifier: BSD-3-Clause
#include "cameras.h"

#include "pipeline/frame_calibration.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/dataset/pinhole_camera.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <cmath>
#include <cstring>

namespace pcl_semantic::python {

StereoCamera
cameraOf(const std::vector<double>& numbers)
{
  if (numbers.size() != 7)
    badParameter("the camera has ", numbers.size(),
                 " numbers, expected seven: fx, fy, cx, cy [px], baseline [m], width, "
                 "height [px]");
  for (const std::size_t i : {5, 6})
    if (!(numbers[i] >= 2.0 && numbers[i] <= 65536.0) ||
        numbers[i] != std::floor(numbers[i]))
      badParameter("the camera's image size is ", numbers[5], " x ", numbers[6],
                   ", expected whole numbers from 2 to 65536");
  return {numbers[0], numbers[1],      numbers[2],     numbers[3],
          numbers[4], int(numbers[5]), int(numbers[6])};
}

void
requireNoFork()
{
  if (isForked()) // it would wait for threads of OpenCV
    badParameter("stereo pairs cannot be computed in a process that was forked after "
                 "the module was loaded; use the start method spawn of "
                 "multiprocessing");
}

cv::Mat
imageOf(const py::object& values, const StereoCamera& camera, const char* name)
{
  const auto array =
      integersOf<std::uint8_t>(values, ("pixels of " + std::string(name)).c_str());
  const bool is_grey = array.ndim() == 2;
  if ((!is_grey && (array.ndim() != 3 || array.shape(2) != 3)) ||
      array.shape(0) != camera.height || array.shape(1) != camera.width)
    badParameter(name, " is ", shapeOf(array), ", expected ", camera.height, " x ",
                 camera.width, " as the camera's, or with three colours");
  cv::Mat image(camera.height, camera.width, is_grey ? CV_8UC1 : CV_8UC3);
  std::memcpy(image.data, array.data(), std::size_t(array.size()));
  if (!is_grey)
    for (cv::Vec3b& pixel : cv::Mat3b(image))
      std::swap(pixel[0], pixel[2]); // OpenCV's order
  return image;
}

namespace {

ConfigParameters
stereoParameters(MapperConfig& config)
{
  ConfigParameters parameters;
  for (const ConfigParameter& parameter : parametersOf(config))
    for (const char* const name : {"stereo", "disparities", "max_deviation"})
      if (parameter.name == name)
        parameters.push_back(parameter);
  return parameters;
}

py::array_t<float>
pixelFeatures(const py::object& left, const py::object& right,
              const std::vector<double>& numbers, const py::object& probabilities,
              const std::vector<int>& ground, const py::kwargs& values)
{
  requireNoFork();
  MapperConfig config;
  setParameters(stereoParameters(config), values);
  config.validate();
  const StereoCamera camera = cameraOf(numbers);
  const cv::Mat images[2] = {imageOf(left, camera, "the left image"),
                             imageOf(right, camera, "the right image")};
  const LabelDistributions distributions =
      distributionsOf(probabilities, py::ssize_t(camera.width) * camera.height);
  std::vector<Label> labels;
  for (const int label : ground) {
    if (label < 1 || label > distributions.classes())
      badParameter("a label of the ground is ", label, ", expected 1 to ",
                   distributions.classes());
    labels.push_back(Label(label));
  }
  const std::vector<PointFeatures> features = released([&] {
    DisparityImage image = makeDisparityEstimator(config.stereo, config.disparities)
                               ->estimate(images[0], images[1]);
    eraseUnsure(image, config.max_deviation);
    const auto cloud = disparityToCloud(image.disparity, images[0], camera);
    return frameFeatures(*cloud, distributions, labels);
  });
  py::array_t<float> result({camera.height, camera.width, int(feature_count)});
  float* next = result.mutable_data();
  for (const PointFeatures& each : features)
    for (std::size_t f = 0; f < feature_count; ++f)
      *next++ = each[Feature(f)];
  return result;
}

} // namespace

void
warnOf(const std::vector<std::string>& doubts)
{
  for (const std::string& doubt : doubts)
    warn(doubt);
}

void
bindCameras(py::module_& module)
{
  module.def(
      "read_camera",
      [](const Path& path) {
        const PinholeCamera camera = released([&] { return readPinholeCamera(path); });
        if (camera.isDistorted())
          badInput(path.text, camera.is_fisheye
                                  ? ": is a fisheye's, expected the camera of "
                                    "undistorted images"
                                  : ": has a distortion, expected the camera of "
                                    "undistorted images, with coefficients of 0");
        warnOf(camera.doubts);
        for (const std::string& doubt :
             doubtsOf(StereoCamera{camera.fx, camera.fy, camera.cx, camera.cy, 1.0,
                                   camera.width, camera.height}))
          warn(path.text + ": " + doubt);
        py::dict read;
        read["fx"] = camera.fx;
        read["fy"] = camera.fy;
        read["cx"] = camera.cx;
        read["cy"] = camera.cy;
        read["width"] = camera.width;
        read["height"] = camera.height;
        return read;
      },
      py::arg("path"),
      "The camera of undistorted images: fx, fy, cx, cy, width and height [px] (0 if "
      "the\n"
      "file states none), of ROS' camera_info, OpenCV's camera_matrix, Kalibr's "
      "camchain or\n"
      "EuRoC's sensor.yaml (.yaml), KITTI's or Middlebury's calib.txt, or a line fx fy "
      "cx cy\n"
      "(.txt). A distortion or a fisheye is refused. Binning and a region of interest "
      "are\n"
      "applied; P of rectified images takes the place of K.");
  module.attr("pixel_feature_names") = py::make_tuple(
      feature_names[0], feature_names[1], feature_names[2], feature_names[3],
      feature_names[4], feature_names[5], feature_names[6]);
  static_assert(feature_count == 7);
  module.def(
      "pixel_features", &pixelFeatures, py::arg("left"), py::arg("right"),
      py::arg("camera"), py::arg("probabilities"), py::kw_only(),
      py::arg("ground") = std::vector<int>{},
      "Features of the pixels of a stereo pair, H x W x 7, in the order of\n"
      "pixel_feature_names, as a label calibration uses them (doc/calibration.md).\n"
      "Unknown ones are NaN. camera: fx, fy, cx, cy [px], baseline [m], width, height\n"
      "[px]. probabilities: H*W x L, of the left image. ground: labels of the ground.\n"
      "The parameters stereo, disparities and max_deviation are those of\n"
      "pcl_semantic_map.");
}

} // namespace pcl_semantic::python
