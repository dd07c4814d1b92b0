// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads a label set (`data/label_sets/\*.yaml`).
 * \throws BadInputException that names file and line, if the file cannot be read or is
 * invalid */
LabelSet readLabelSet(const std::string& path);

/** \brief Reads a label set; the eleven classes of KITTI if \a path is empty. */
LabelSet readLabelSetOrDefault(const std::string& path);

/** \brief Writes a file for readLabelSet().
 * \throws OutputException if the file cannot be written */
void writeLabelSet(const std::string& path, const LabelSet& label_set);

/** \brief Reads a mapping from ids to the classes of \a label_set
 * (`data/label_mappings/\*.yaml`), including the ids without a class.
 * \param[in] path of a file, the name of a built-in mapping
 * (`semantic_kitti_to_kitti11`), or `zero_based` for numbers from 0 to L - 1, the usual
 * convention for training
 * \throws BadInputException with file and line, for example for an unknown class */
LabelMapping readLabelMapping(const std::string& path, const LabelSet& label_set);

/** \brief Reads a mapping for label images. `colours`: they contain the colours of the
 * classes; empty \a path: they contain labels.
 * \throws BadInputException as readLabelMapping(), or if two classes have the same
 * colour */
PixelMapping readPixelMapping(const std::string& path, const LabelSet& label_set);

/** \brief Help of an option that readLabelMapping() reads. */
constexpr const char* kLabelMappingHelp =
    "mapping from numbers in the input to classes of the label set: file (.yaml), name "
    "of an installed file (semantic_kitti_to_kitti11) or zero_based (default: numbers "
    "are labels, 0 = unlabelled)";

/** \brief Help of an option that readPixelMapping() reads. */
constexpr const char* kPixelMappingHelp =
    "mapping from numbers in the input to classes of the label set: file (.yaml), name "
    "of an installed file (semantic_kitti_to_kitti11), zero_based or colours = .png "
    "files have the class colours (default: numbers are labels, 0 = unlabelled)";

} // namespace pcl_semantic
