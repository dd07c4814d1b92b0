// SPDX-License-Identifier: BSD-3-Clause
#include "ply_lines.h"

#include "core/text_stream.h"

#include <pcl_semantic/files/atomic_file.h>

namespace pcl_semantic {

LabelColour
colourOf(Label label, const LabelSet& label_set)
{
  if (label == kUnlabelled || label_set.size() == 0)
    return {255, 255, 255};
  return label_set[label].colour;
}

void
writePlyLines(const std::string& path, const PlyLines& lines)
{
  TextStream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << lines.corners.size()
       << "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar "
          "red\nproperty uchar green\nproperty uchar blue\nelement edge "
       << lines.edges.size()
       << "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  text.precision(9);
  for (const auto& [position, colour] : lines.corners)
    text << position.x() << " " << position.y() << " " << position.z() << " "
         << int(colour[0]) << " " << int(colour[1]) << " " << int(colour[2]) << "\n";
  for (const auto& [from, to] : lines.edges)
    text << from << " " << to << "\n";
  writeTextFile(path, text.str());
}

} // namespace pcl_semantic
