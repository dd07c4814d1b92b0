// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/temporary_folder.h"
#include "synthesize/labels.h"
#include "synthesize/writer.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/pipeline/calibration_trial.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

/** \brief A small sequence with ground truth for all frames except the second. */
class CalibrationStreet : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    folder_ = std::make_unique<TemporaryFolder>();
    const SyntheticScene scene(5, frames);
    const SyntheticRenderer renderer(scene, 208, 64);
    const SyntheticWriter writer(folder_->path("street"));
    writer.writeSequence(scene, renderer.camera());
    for (int i = 0; i < frames; ++i) {
      const SyntheticView view = renderer.render(i);
      writer.writeFrame(view, syntheticDistributions(view, 5));
    }
    std::filesystem::remove(folder_->path("street/gt/000001.png"));
  }

  static void
  TearDownTestSuite()
  {
    folder_.reset();
  }

  static LabelSet
  labelSet()
  {
    return readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
  }

  static std::shared_ptr<const CalibrationSequence>
  open()
  {
    return std::make_shared<CalibrationSequence>(
        CalibrationFolders{folder_->path("street"), folder_->path("street/labels"),
                           folder_->path("street/gt")},
        labelSet().size());
  }

  static MapperConfig
  coarse()
  {
    MapperConfig config;
    config.map.voxel_size = 0.2;
    return config;
  }

  static constexpr int frames = 3;
  static inline std::unique_ptr<TemporaryFolder> folder_;
};

} // namespace pcl_semantic
