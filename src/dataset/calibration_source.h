// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/yaml_config.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Messages about doubtful or unused values, one per line. */
using Doubts = std::vector<std::string>;

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

/** \brief A calibration file in YAML, or the mapping of one camera in it. */
struct CalibrationSource {
  using Keys = std::vector<std::string>;

  std::string path;
  YamlMap map;

  /** \brief Reads a file.
   * \throws BadInputException for XML, which is not supported */
  static CalibrationSource load(const std::string& path);

  /** \brief The mapping under a key. */
  CalibrationSource
  inner(const std::string& key) const
  {
    return {path, map.requireMap(key)};
  }

  /** \brief Returns the existing one of a value's keys; empty if none exists.
   * \throws BadInputException if two exist */
  std::string find(const Keys& keys) const;

  /** \brief "FILE line N: KEY". */
  std::string where(const std::string& key) const;

  /** \brief The numbers of a matrix or a list, row by row.
   * \param[in] count expected number; 0 = any */
  std::vector<double> numbers(const Keys& keys, std::size_t count = 0) const;

  /** \brief A non-negative integer; 0 if missing. */
  int count(const std::string& key) const;

  Eigen::Matrix3d square(const Keys& keys) const;

  /** \throws BadInputException at an unknown model */
  void requireModel(const std::string& key, const Keys& known) const;
};

/** \brief Deviation of R R^T from the identity. */
double deviationOf(const Eigen::Matrix3d& R);

/** \brief Returns the rotation nearest to a rounded one.
 * \param[in] where for messages
 * \param[in,out] doubts receives one if the error exceeds rounding
 * \throws BadInputException if R is far from any rotation */
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& R, const std::string& where,
                                Doubts& doubts);

} // namespace pcl_semantic
