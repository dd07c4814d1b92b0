// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/clouds/labelled_cloud.h>

int
main()
{
  const pcl_semantic::LabelledCloud read =
      pcl_semantic::labelledCloudOf(pcl_semantic::PcdTable(), "empty");
  return read.cloud->empty() ? 0 : 1;
}
