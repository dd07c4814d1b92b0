// SPDX-License-Identifier: BSD-3-Clause

// That an installed library finds its data is checked by test/downstream.

#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/data_folder.h>

#include <gtest/gtest.h>

#include <filesystem>

namespace {

using namespace pcl_semantic;

TEST(DataFolder, OfABuildIsThatOfTheSources)
{
  for (const char* name : {"label_sets/kitti11.yaml", "presets/paper.yaml"})
    EXPECT_TRUE(std::filesystem::equivalent(
        findDataFile(name), std::string(PCL_SEMANTIC_SOURCE_DIR "/data/") + name));
}

TEST(DataFolder, SaysWhatIsNotThere)
{
  EXPECT_EQ(
      thrownMessage<BadInputException>([] { findDataFile("label_sets/none.yaml"); }),
      "label_sets/none.yaml: is not among the data of this installation");
}

} // namespace
