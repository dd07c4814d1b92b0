// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/yaml_config.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Messages about values that are doubtful or not used, a line each. */
using Doubts = std::vector<std::string>;

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

/** \brief A calibration file in YAML, or the mapping of one camera in it. */
struct CalibrationSource {
  using Keys = std::vector<std::string>;

  std::string path;
  YamlMap map;

  /** \brief Reads a file. \throws BadInputException that names XML, which is not read
   */
  static CalibrationSource load(const std::string& path);

  /** \brief The mapping under a key. */
  CalibrationSource
  inner(const std::string& key) const
  {
    return {path, map.requireMap(key)};
  }

  /** \brief The one of a value's keys that is there; empty if none is.
   * \throws BadInputException if two are */
  std::string find(const Keys& keys) const;

  /** \brief "FILE line N: KEY". */
  std::string where(const std::string& key) const;

  /** \brief The numbers of a matrix or a list, row after row.
   * \param[in] count how many are expected; 0 = any number */
  std::vector<double> numbers(const Keys& keys, std::size_t count = 0) const;

  /** \brief A whole number that is not negative; 0 if it is not there. */
  int count(const std::string& key) const;

  Eigen::Matrix3d square(const Keys& keys) const;

  /** \throws BadInputException if a model is stated that is not one of the known */
  void requireModel(const std::string& key, const Keys& known) const;
};

/** \brief How far R R^T is off the identity. */
double deviationOf(const Eigen::Matrix3d& R);

/** \brief The rotation nearest to one with fewer digits than those of a double.
 * \param[in] where for messages
 * \param[in,out] doubts gets one if more than digits are missing
 * \throws BadInputException if it is far from any */
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& R, const std::string& where,
                                Doubts& doubts);

} // namespace pcl_semantic
