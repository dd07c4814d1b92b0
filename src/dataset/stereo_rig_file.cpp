// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/stereo_rig.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/yaml_config.h>

#include <pcl/console/print.h>

#include <Eigen/SVD>

#include <cmath>

namespace pcl_semantic {

namespace {

using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Keys = std::vector<std::string>;

// A calibration file and its name.
struct Source {
  std::string path;
  YamlMap map;
};

Source
load(const std::string& path)
{
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty())
      continue;
    if (line.text[0] == '<')
      PCL_THROW_EXCEPTION(BadInputException,
                          path
                              << ": is XML, expected YAML as cv::FileStorage writes it "
                                 "to a file named .yaml");
    break;
  }
  return {path, YamlMap::load(path)};
}

// The one of the keys that is there; empty if none is.
std::string
findKey(const Source& source, const Keys& keys)
{
  std::string found;
  for (const std::string& key : keys) {
    if (!source.map.has(key))
      continue;
    if (!found.empty())
      PCL_THROW_EXCEPTION(BadInputException,
                          source.map.where(key) << ": '" << key << "' is '" << found
                                                << "' once more, expected one of them");
    found = key;
  }
  return found;
}

std::vector<double>
numbersOf(const std::vector<std::string>& words, const std::string& where)
{
  std::vector<double> numbers;
  for (const std::string& word : words) {
    numbers.push_back(parseNumber(word, where));
    if (!std::isfinite(numbers.back()))
      PCL_THROW_EXCEPTION(BadInputException,
                          where << ": '" << word << "' is not a finite number");
  }
  return numbers;
}

// The numbers of a matrix, row after row.
std::vector<double>
readMatrix(const Source& source, const Keys& keys)
{
  const std::string key = findKey(source, keys);
  if (key.empty()) {
    std::string names;
    for (const std::string& name : keys)
      names += (names.empty() ? "'" : " or '") + name + "'";
    PCL_THROW_EXCEPTION(BadInputException,
                        source.path << ": key " << names << " is missing");
  }
  const std::string where = source.map.where(key) + ": " + key;
  if (!source.map.isMap(key))
    return numbersOf(source.map.require<std::vector<std::string>>(key), where);
  const YamlMap matrix = source.map.requireMap(key);
  const std::vector<double> data =
      numbersOf(matrix.require<std::vector<std::string>>("data"), where);
  const int rows = matrix.require<int>("rows"), columns = matrix.require<int>("cols");
  if (rows < 1 || columns < 1 || double(rows) * columns != double(data.size()))
    PCL_THROW_EXCEPTION(BadInputException, where << ": has " << data.size()
                                                 << " numbers, expected " << rows
                                                 << " x " << columns);
  return data;
}

std::vector<double>
readMatrix(const Source& source, const Keys& keys, std::size_t count)
{
  std::vector<double> data = readMatrix(source, keys);
  const std::string key = findKey(source, keys);
  if (data.size() != count)
    PCL_THROW_EXCEPTION(BadInputException, source.map.where(key)
                                               << ": " << key << ": has " << data.size()
                                               << " numbers, expected " << count);
  return data;
}

Eigen::Matrix3d
readSquare(const Source& source, const Keys& keys)
{
  return Eigen::Map<const RowMajor33>(readMatrix(source, keys, 9).data());
}

// Fewer digits than those of a double leave no exact rotation.
Eigen::Matrix3d
readRotation(const Source& source)
{
  const Eigen::Matrix3d R = readSquare(source, {"R"});
  const double deviation = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
  const std::string where = source.map.where("R") + ": R";
  if (!(deviation <= 1e-2) || R.determinant() < 0.0)
    PCL_THROW_EXCEPTION(BadInputException,
                        where << ": is no rotation (determinant " << R.determinant()
                              << ", R R^T is off by " << deviation << ")");
  if (deviation > 1e-4)
    PCL_WARN("%s: was not quite a rotation and made one\n", where.c_str());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU |
                                                     Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

void
readSize(const Source& source, StereoRig& rig)
{
  const bool has_width = source.map.get("image_width", rig.width);
  const bool has_height = source.map.get("image_height", rig.height);
  if (has_width != has_height)
    PCL_THROW_EXCEPTION(BadInputException,
                        source.path
                            << ": expected both 'image_width' and 'image_height'");
  const std::string key = findKey(source, {"image_size", "imageSize"});
  if (!has_width && !key.empty()) {
    const auto size = source.map.require<std::vector<int>>(key);
    if (size.size() != 2)
      PCL_THROW_EXCEPTION(BadInputException, source.map.where(key)
                                                 << ": " << key << ": has "
                                                 << size.size()
                                                 << " numbers, expected width, height");
    rig.width = size[0];
    rig.height = size[1];
  }
  if ((has_width || !key.empty()) && (rig.width < 2 || rig.height < 2))
    PCL_THROW_EXCEPTION(BadInputException, source.path << ": the image size is "
                                                       << rig.width << " x "
                                                       << rig.height << " pixels");
}

} // namespace

StereoRig
readStereoRig(const std::string& path, const std::string& extrinsics_path)
{
  const Source source = load(path);
  const Source extrinsics = extrinsics_path.empty() ? source : load(extrinsics_path);
  StereoRig rig;
  readSize(source, rig);
  rig.K1 = readSquare(source, {"K1", "M1", "cameraMatrix1", "camera_matrix_1"});
  rig.D1 = readMatrix(source, {"D1", "distCoeffs1", "dist_coeffs_1"});
  rig.K2 = readSquare(source, {"K2", "M2", "cameraMatrix2", "camera_matrix_2"});
  rig.D2 = readMatrix(source, {"D2", "distCoeffs2", "dist_coeffs_2"});
  rig.R = readRotation(extrinsics);
  rig.T = Eigen::Map<const Eigen::Vector3d>(readMatrix(extrinsics, {"T"}, 3).data());
  try {
    rig.validate();
  }
  catch (const InvalidParameterException& error) {
    const std::string message = error.what();
    PCL_THROW_EXCEPTION(BadInputException, (message[0] == 'T' ? extrinsics.path : path)
                                               << ": " << message);
  }
  return rig;
}

} // namespace pcl_semantic
