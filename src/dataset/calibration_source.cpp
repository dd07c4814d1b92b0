// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_source.h"

#include "core/fail.h"

#include <pcl_semantic/files/input_file.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>

namespace pcl_semantic {

CalibrationSource
CalibrationSource::load(const std::string& path)
{
  for (const TextLine& line : readLines(path)) {
    if (line.text.empty())
      continue;
    if (line.text[0] == '<')
      badInput(path, ": is XML, expected YAML as cv::FileStorage writes it to a file "
                     "named .yaml");
    break;
  }
  return {path, YamlMap::load(path)};
}

std::string
CalibrationSource::find(const Keys& keys) const
{
  std::string found;
  for (const std::string& key : keys) {
    if (!map.has(key))
      continue;
    if (!found.empty())
      badInput(map.where(key), ": '", key, "' repeats '", found,
               "', expected one of them");
    found = key;
  }
  return found;
}

std::string
CalibrationSource::where(const std::string& key) const
{
  return map.where(key) + ": " + key;
}

std::vector<double>
CalibrationSource::numbers(const Keys& keys, std::size_t count) const
{
  const std::string key = find(keys);
  if (key.empty()) {
    std::string names;
    for (const std::string& name : keys)
      names += (names.empty() ? "'" : " or '") + name + "'";
    badInput(path, ": key ", names, " is missing");
  }
  const bool is_matrix = map.isMap(key);
  const YamlMap matrix = is_matrix ? map.requireMap(key) : map;
  std::string words;
  for (const std::string& word :
       matrix.require<std::vector<std::string>>(is_matrix ? "data" : key))
    words += word + " ";
  const std::vector<double> data = parseNumbers(words, where(key));
  if (is_matrix) {
    const int rows = matrix.require<int>("rows"), columns = matrix.require<int>("cols");
    if (rows < 0 || columns < 0 || double(rows) * columns != double(data.size()))
      badInput(where(key), ": has ", data.size(), " numbers, expected ", rows, " x ",
               columns);
  }
  if (count > 0 && data.size() != count)
    badInput(where(key), ": has ", data.size(), " numbers, expected ", count);
  return data;
}

int
CalibrationSource::count(const std::string& key) const
{
  int number = 0;
  map.get(key, number);
  if (number < 0 || number > 1000000)
    badInput(where(key), ": is ", number, ", expected 0 to 1000000");
  return number;
}

Eigen::Matrix3d
CalibrationSource::square(const Keys& keys) const
{
  using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor33>(numbers(keys, 9).data());
}

void
CalibrationSource::requireModel(const std::string& key, const Keys& known) const
{
  std::string model;
  if (!map.get(key, model) || std::count(known.begin(), known.end(), model))
    return;
  std::string names;
  for (const std::string& name : known)
    if (!name.empty())
      names += (names.empty() ? "" : " or ") + inQuotes(name);
  badInput(where(key), " is ", inQuotes(model), ", expected ", names,
           "; omnidirectional models are not supported, calibrate a fisheye as "
           "'equidistant'");
}

double
deviationOf(const Eigen::Matrix3d& R)
{
  return (R * R.transpose() - Eigen::Matrix3d::Identity()).norm();
}

Eigen::Matrix3d
nearestRotation(const Eigen::Matrix3d& R, const std::string& where, Doubts& doubts)
{
  const double deviation = deviationOf(R);
  if (!(deviation <= 1e-2) || R.determinant() < 0.0)
    badInput(where, ": is no rotation (determinant ", R.determinant(),
             ", R R^T is off by ", deviation, ")");
  if (deviation > 1e-4)
    doubts.push_back(where + ": was not exactly a rotation and was corrected");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU |
                                                     Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

} // namespace pcl_semantic
