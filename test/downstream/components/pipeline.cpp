// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_sequence.h>
#include <pcl_semantic/pipeline/mapper_config.h>

int
main()
{
  pcl_semantic::MapperConfig config;
  config.validate();
  return 0;
}
