// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <cstddef>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The clouds (readCloudTable()) of a folder or a pattern in natural order, one
 * per frame.
 *
 * If every name is an integer up to 999999 (`000012.pcd`), it is the frame number.
 * Otherwise frame n is the n-th cloud from 0. If every name is a time with a fraction
 * (`1403636579.763555.pcd`), it is the frame's time. */
class CloudSequence {
public:
  /** \param[in] pattern see findFiles(): a folder, or `scan-*.pcd`
   * \param[in] times file of times, row n for frame n [s]; empty = times in the names,
   * or ten frames per second
   * \param[in] columns of `.bin` scans, as for readCloudTable()
   * \throws BadInputException if the pattern matches nothing, two names have one
   * number, or `times` is damaged or too short */
  explicit CloudSequence(const std::string& pattern, const std::string& times = "",
                         ScanColumns columns = {});

  std::size_t
  size() const
  {
    return paths_.size();
  }

  int
  frameNumber(std::size_t i) const
  {
    return numbers_.at(i);
  }

  double
  timestamp(std::size_t i) const
  {
    return times_.at(i);
  }

  const std::string&
  path(std::size_t i) const
  {
    return paths_.at(i);
  }

  /** \brief Reads the i-th cloud.
   * \param[in] classes L
   * \param[in] confidence probability of the class in `label`, if the cloud has no
   * field `probability`
   * \param[in] mapping as for readLabelledCloud()
   * \return the cloud with PcdTable::doubts, and whether probabilities override the
   * mapping
   * \throws BadInputException as readLabelledCloud(), if the labels are not of these
   * classes, or if most points are so far away that they must be in the world's
   * frame */
  CloudFrame frame(std::size_t i, int classes, float confidence,
                   const LabelMapping* mapping = nullptr) const;

private:
  std::vector<std::string> paths_;
  std::vector<int> numbers_;
  std::vector<double> times_; ///< [s]
  ScanColumns columns_;
};

} // namespace pcl_semantic
