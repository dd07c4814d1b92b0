// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads a label set (`data/label_sets/\*.yaml`).
 * \throws BadInputException with file and line */
LabelSet readLabelSet(const std::string& path);

/** \brief The same; the eleven classes of KITTI if \a path is empty. */
LabelSet readLabelSetOrDefault(const std::string& path);

/** \brief Writes a file that readLabelSet() takes. \throws OutputException */
void writeLabelSet(const std::string& path, const LabelSet& label_set);

/** \brief Reads a mapping of ids to the classes of \a label_set
 * (`data/label_mappings/\*.yaml`), and the ids that are known to have none.
 * \param[in] path of the file, the name of one of those (`semantic_kitti_to_kitti11`),
 * or `zero_based` for numbers from 0 to L - 1, as networks are trained on them
 * \throws BadInputException with file and line, at an unknown class for example */
LabelMapping readLabelMapping(const std::string& path, const LabelSet& label_set);

/** \brief The same for label images, of which `colours` says that they are drawn in the
 * colours of the classes, and an empty \a path that they hold labels. \throws
 * BadInputException also if two classes have one */
PixelMapping readPixelMapping(const std::string& path, const LabelSet& label_set);

/** \brief Help of an option that readLabelMapping() reads. */
constexpr const char* kLabelMappingHelp =
    "numbers of the input to classes of the label set: a file (YAML), the name of one "
    "that is installed (semantic_kitti_to_kitti11), or zero_based (default: they are "
    "labels, 0 = unlabelled)";

/** \brief Help of an option that readPixelMapping() reads. */
constexpr const char* kPixelMappingHelp =
    "numbers of the input to classes of the label set: a file (YAML), the name of one "
    "that is installed (semantic_kitti_to_kitti11), zero_based, or of .png colours, "
    "those of the classes (default: they are labels, 0 = unlabelled)";

} // namespace pcl_semantic
