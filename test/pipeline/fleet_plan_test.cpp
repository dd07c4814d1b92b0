// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/fleet_plan.h>

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

TEST(FleetPlan, NamesDrivesAndTheirOptions)
{
  const TemporaryFolder folder;
  const FleetPlan plan = readFleetPlan(folder.write("plan.yaml", R"(output: city
options: {voxel_size: 0.2, submap_every: 20m, window: [8, 8, 4]}
drives:
  - {name: monday, sequence: a, labels: a/labels}
  - {name: tuesday, sequence: b, voxel_size: 0.4, corrected_poses: b.txt, strict: true}
)"));
  EXPECT_EQ(plan.output, "city");
  ASSERT_EQ(plan.drives.size(), 2u);
  const FleetDrive &monday = plan.drives[0], &tuesday = plan.drives[1];
  EXPECT_EQ(monday.name, "monday");
  EXPECT_EQ(monday.corrected_poses, "");
  EXPECT_EQ(monday.inputs.sequence.folder, "a");
  EXPECT_EQ(monday.inputs.labels, "a/labels");
  EXPECT_EQ(monday.submap_every, "20m");
  EXPECT_EQ(monday.config.map.voxel_size, 0.2);
  EXPECT_EQ(monday.inputs.given,
            (std::set<std::string>{"voxel-size", "submap-every", "window", "sequence",
                                   "labels"}));
  EXPECT_EQ(tuesday.corrected_poses, "b.txt");
  EXPECT_EQ(tuesday.config.map.voxel_size, 0.4) << "its own option";
  EXPECT_EQ(tuesday.config.map.window, Eigen::Vector3d(8, 8, 4)) << "of all drives";
  EXPECT_TRUE(tuesday.inputs.sequence.strict);
}

TEST(FleetPlan, ReadsParametersBesideIt)
{
  const TemporaryFolder folder;
  folder.write("preset.yaml", "voxel_size: 0.3\nmax_depth: 9\n");
  const FleetPlan plan = readFleetPlan(folder.write("plan.yaml", R"(output: city
options: {config: preset.yaml, max_depth: 7}
drives: [{name: a, sequence: b}]
)"));
  EXPECT_EQ(plan.drives[0].config.map.voxel_size, 0.3);
  EXPECT_EQ(plan.drives[0].config.map.max_range, 7.0) << "overrides the file";
  EXPECT_EQ(plan.drives[0].submap_every, "50m");
}

TEST(FleetPlan, SaysWhatCannotBe)
{
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    const std::string path = folder.write("plan.yaml", text);
    const std::string message =
        thrownMessage<BadInputException>([&] { readFleetPlan(path); });
    EXPECT_EQ(message.rfind(path, 0), 0u) << message;
    return message;
  };
  const std::string begin = "output: city\ndrives:\n";
  for (const auto& [text, says] : {
           std::pair{std::string("drives:\n  - {name: a}\n"), "'output' is missing"},
           {std::string("output: city\n"), "'drives' is missing"},
           {std::string("output: ''\ndrives: [{name: a}]\n"), "line 1: is empty"},
           {begin + "  - {name: a, print-config: b}\n", "'print-config' is no option"},
           {begin + "  - {name: a, help: b}\n", "'help' is no option of a drive"},
           {std::string("output: city\ndrives: []\n"), "line 2: there is no drive"},
           {begin + "  - {sequence: a}\n", "line 3: key 'name' is missing"},
           {begin + "  - {name: ../a}\n", "line 3: '../a', expected letters"},
           {begin + "  - {name: .a}\n", "line 3: '.a', expected letters"},
           {begin + "  - {name: ''}\n", "line 3: '', expected letters"},
           {begin + "  - {name: a}\n  - {name: a}\n",
            "line 4: there is a drive 'a' already"},
           {begin + "  - {name: a, archive: b}\n", "'archive' is no option of a drive"},
           {begin + "  - {name: a, labels: [1, 2]}\n", "line 3"},
           {begin + "  - {name: a, strict: maybe}\n",
            "'maybe', expected false or true"},
           {begin + "  - {name: a, hit_share: 1}\n", "was renamed to min_hit_ratio"},
           {begin + "  - {name: a}\nrives: 3\n", "rives"},
       })
    EXPECT_TRUE(holds(refusal(text), says)) << text;
}

} // namespace

} // namespace pcl_semantic
