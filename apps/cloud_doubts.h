// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/files/cloud_file.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Mapping for clouds with irrelevant labels: accepts all numbers. */
const LabelMapping& anyLabels();

/** \brief Formats PcdTable::doubts for the end of an error message: "; field 'lbl' is
 * not read ...".
 * \param[in] path of the cloud in the message */
std::string textOfDoubts(const std::vector<std::string>& doubts,
                         const std::string& path);

/** \brief Warns of points at exactly 0 0 0, see countNoReturns().
 * \param[in] path of the cloud
 * \param[in] count 0 = no warning */
void warnOfNoReturns(const std::string& path, std::size_t count);

/** \brief Refuses options about labels if a cloud has probabilities, which replace its
 * labels.
 * \param[in] path of the cloud
 * \param[in] options given options, with their dashes
 * \throws InvalidParameterException that names the option and the cloud */
void refuseForProbabilities(const std::string& path,
                            const std::vector<std::string>& options);

/** \brief Warns in its destructor, in one line, of numbers missing in a label
 * mapping. */
class MappingWatch {
public:
  MappingWatch() = default;

  /** \param[in] name of the mapping
   * \param[in] mapping whose copies are used; mappings by colour or label are complete
   * \param[in] unit of the mapped elements: "points" */
  MappingWatch(std::string name, const PixelMapping& mapping, std::string unit);

  MappingWatch(MappingWatch&& other) noexcept;
  MappingWatch& operator=(MappingWatch&& other) noexcept;
  ~MappingWatch();

private:
  std::string name_, unit_;
  std::optional<LabelMapping> mapping_;
};

} // namespace pcl_semantic::tool
