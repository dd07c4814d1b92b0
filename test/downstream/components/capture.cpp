// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/capture/video_pair_sequence.h>

int
main()
{
  return pcl_semantic::isVideo("left.mp4") ? 0 : 1;
}
