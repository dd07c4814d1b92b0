// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/listed_labels.h>

#include <sstream>

namespace pcl_semantic {

std::vector<Label>
listedLabels(const std::string& names, const LabelSet& label_set,
             const std::string& what)
{
  std::vector<Label> labels;
  if (names == "none")
    return labels;
  std::istringstream stream(names);
  for (std::string name; std::getline(stream, name, ',');) {
    labels.push_back(label_set.find(name));
    if (labels.back() == kUnlabelled)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          what << ": class '" << name << "' is not in the label set");
  }
  return labels;
}

} // namespace pcl_semantic
