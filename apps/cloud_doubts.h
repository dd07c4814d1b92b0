// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/cloud_file.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief For clouds whose labels do not matter: takes any numbers. */
const LabelMapping& anyLabels();

/** \brief PcdTable::doubts for the end of an error's line: "; field 'lbl' is not read
 * ...". \param[in] path of the cloud, which the line names */
std::string textOfDoubts(const std::vector<std::string>& doubts,
                         const std::string& path);

/** \brief Warns of points at exactly 0 0 0, which countNoReturns() counts.
 * \param[in] path of the cloud \param[in] count 0 = nothing is said */
void warnOfNoReturns(const std::string& path, std::size_t count);

/** \brief Refuses options about labels that a cloud does not use, since it has
 * probabilities. \param[in] path of the cloud
 * \param[in] options that were given, with their dashes
 * \throws InvalidParameterException that names the option and the cloud */
void refuseForProbabilities(const std::string& path,
                            const std::vector<std::string>& options);

/** \brief Warns at its end, in one line, of the numbers that a label mapping lacked. */
class MappingWatch {
public:
  MappingWatch() = default;

  /** \param[in] name of the mapping
   * \param[in] mapping whose copies are used; colours and labels lack nothing
   * \param[in] unit that it was used for: "points" */
  MappingWatch(std::string name, const PixelMapping& mapping, std::string unit);

  MappingWatch(MappingWatch&& other) noexcept;
  MappingWatch& operator=(MappingWatch&& other) noexcept;
  ~MappingWatch();

private:
  std::string name_, unit_;
  std::optional<LabelMapping> mapping_;
};

} // namespace pcl_semantic::tool
