// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/io/map_archive.h>

#include <pcl_semantic/core/exceptions.h>

int
main()
{
  try {
    pcl_semantic::MapReader::open("no/such.map");
  }
  catch (const pcl_semantic::BadInputException&) {
    return 0;
  }
  return 1;
}
