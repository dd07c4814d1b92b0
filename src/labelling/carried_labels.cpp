// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/labelling/carried_labels.h>

#include "core/fail.h"

namespace pcl_semantic {

LabelDistributions
carryLabels(const LabelDistributions& image, const StereoCamera& camera,
            const std::vector<SeenPoint>& seen)
{
  if (image.size() != Eigen::Index(camera.width) * camera.height)
    fail<InvalidParameterException>("labels of ", image.size(),
                                    " pixels for an image of ", camera.width, " x ",
                                    camera.height);
  LabelDistributions points(image.classes(), Eigen::Index(seen.size()));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].depth == 0.0f)
      continue;
    if (seen[i].row >= camera.height || seen[i].column >= camera.width)
      fail<InvalidParameterException>("point ", i, " is seen outside the image");
    points.matrix().col(Eigen::Index(i)) =
        image.matrix().col(Eigen::Index(seen[i].row) * camera.width + seen[i].column);
  }
  return points;
}

} // namespace pcl_semantic
