// SPDX-License-Identifier: BSD-3-Clause
#include "default_label_set.h"

#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>

namespace pcl_semantic::tool {

LabelSet
readLabelSetOrDefault(const std::string& path)
{
  return readLabelSet(path.empty() ? findDataFile("label_sets/kitti11.yaml") : path);
}

} // namespace pcl_semantic::tool
