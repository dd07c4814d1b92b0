// SPDX-License-Identifier: BSD-3-Clause

// Makes each allocation fail once.

#include "faults.h"
#include "fuzz/doors.h"

#include "support/archives.h"
#include "support/random_scan.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <opencv2/core.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <set>

namespace pcl_semantic {

namespace {

// The first allocations one by one, then about every sixteenth.
long
nextOf(long n)
{
  return n + 1 + n / 16;
}

// Runs a body with each of these allocations failing. It must end as if nothing had
// happened, or with an exception for missing memory.
// \param[in] check called after each run
// \param[in] may_refuse whether BadInputException is also accepted
template <typename Body>
void
sweep(
    Body&& body, const std::function<void()>& check = [] {}, bool may_refuse = false)
{
  const ThreadScope one_thread(1); // other threads' allocations do not fail
  body();                          // creates objects that are made only once
  check();
  int failures = 0;
  for (long before = 0;; before = nextOf(before)) {
    SCOPED_TRACE(before);
    std::optional<FailingAllocation> fault(std::in_place, before);
    try {
      body();
    }
    catch (const std::bad_alloc&) {
    }
    catch (const cv::Exception& error) {
      EXPECT_EQ(error.code, cv::Error::StsNoMem) << error.what();
    }
    catch (const BadInputException& error) {
      EXPECT_TRUE(may_refuse) << error.what();
    }
    catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
    const bool has_failed = fault->hasFailed();
    fault.reset();
    check();
    failures += has_failed;
    if (!has_failed || testing::Test::HasFailure())
      break;
  }
  EXPECT_GT(failures, 0);
}

// Readers of images and YAML, whose libraries report missing memory as a damaged file.
bool
hasLibrary(const std::string& door)
{
  static const std::set<std::string> doors{
      "calibration", "crf_config",    "depth_png", "distributions_png",
      "fleet_plan",  "image_jpg",     "image_png", "label_mapping",
      "label_set",   "mapper_config", "network",   "pinhole_camera",
      "stereo_rig",  "undistorter"};
  return doors.count(door) > 0;
}

SemanticVoxelMap::Parameters
smallWindow()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.25;
  parameters.window = Eigen::Vector3d(8, 8, 8);
  parameters.max_range = 4.0;
  return parameters;
}

} // namespace

TEST(Starved, ReadersRunOutOfMemory)
{
  const std::filesystem::path corpora = PCL_SEMANTIC_SOURCE_DIR "/test/fuzz/corpus";
  for (const Door& door : doors()) {
    SCOPED_TRACE(door.name);
    // libtiff 4.5 writes to memory it failed to allocate. Destructors of nlohmann's
    // JSON allocate, and end the program if they cannot.
    if (door.name == "image_tif" || door.name == "depth_tif" ||
        door.name == "summary" || door.name == "objects")
      continue;
#if defined(__SANITIZE_ADDRESS__) // OpenCV leaks pixels without a header
    if (door.name.rfind("image_", 0) == 0 ||
        door.name.find("_png") != std::string::npos)
      continue;
#endif
    for (const auto& file : std::filesystem::directory_iterator(corpora / door.name)) {
      const std::vector<std::uint8_t> bytes = readBytes(file.path());
      const std::string text(bytes.begin(), bytes.end());
      try {
        door.read(text);
      }
      catch (const std::exception&) {
        continue; // a refused one
      }
      sweep([&] { door.read(text); }, [] {}, hasLibrary(door.name));
      break;
    }
  }
}

// After a scan without memory the map can still be used.
TEST(Starved, TheMapRunsOutOfMemory)
{
  const LabelledScan scan = makeRandomScan(200, 3.0f, 3, 1);
  SemanticVoxelMap used(threeClasses(), smallWindow());
  sweep([&] {
    SemanticVoxelMap map(threeClasses(), smallWindow());
    map.integrate(scan.cloud, Eigen::Isometry3d::Identity(), scan.distributions);
    map.occupied();
  });
  sweep([&] {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int step = 0; step < 3; ++step) { // out of the window, and back
      pose.translation().x() = step == 1 ? 20.0 : 0.0;
      used.integrate(scan.cloud, pose, scan.distributions);
    }
    used.occupiedEverywhere();
  });
  EXPECT_GT(used.occupied().size(), 0u);
}

TEST(Starved, TheCrfRunsOutOfMemory)
{
  const LabelledScan scan = makeRandomScan(60, 1.0f, 3, 2);
  for (const CRFModelType model : {CRFModelType::dense, CRFModelType::hierarchical}) {
    pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud(
        new pcl::PointCloud<pcl::PointXYZRGBL>);
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
      pcl::PointXYZRGBL point;
      point.getVector3fMap() = scan.cloud[i].getVector3fMap();
      point.rgba = scan.cloud[i].rgba;
      point.label = std::uint32_t(scan.distributions.mapLabel(Eigen::Index(i)));
      cloud->push_back(point);
    }
    pcl::PointIndices clique;
    clique.indices = {0, 1, 2, 3};
    const auto refine = [&] {
      SemanticCRF<pcl::PointXYZRGBL> crf;
      crf.setInputCloud(cloud);
      crf.setModel(model);
      crf.setLabelDistributions(scan.distributions);
      if (model == CRFModelType::hierarchical)
        crf.setCliques({clique});
      pcl::PointCloud<pcl::PointXYZRGBL> refined;
      crf.filter(refined);
      return refined;
    };
    for (auto& point : *cloud) // to detect a cloud that was not refined
      point.label = 0;
    const pcl::PointCloud<pcl::PointXYZRGBL> expected = refine();
    sweep([&] {
      const pcl::PointCloud<pcl::PointXYZRGBL> refined = refine();
      ASSERT_EQ(refined.size(), cloud->size());
      for (std::size_t i = 0; i < refined.size(); ++i)
        EXPECT_EQ(refined[i].label, expected[i].label);
    });
  }
}

// After any failed allocation, the archive has its last committed state.
TEST(Starved, TheArchiveRunsOutOfMemory)
{
  const TemporaryFolder folder;
  const Blocks first = makeRandomBlocks(5, 1), both = [&] {
    Blocks blocks = first;
    for (const auto& [index, block] : makeRandomBlocks(5, 2))
      blocks[index] = block;
    return blocks;
  }();
  const std::string begun = folder.path("begun"), path = folder.path("map");
  {
    const auto archive = MapArchive::create(begun, makeArchiveHeader());
    putAll(first, *archive);
    archive->commit({});
    EXPECT_TRUE(archive->close());
  }
  const auto begin = [&] {
    for (const char* const ending : {"", "-wal", "-shm"})
      std::filesystem::remove(path + ending);
    std::filesystem::copy_file(begun, path);
  };
  bool committed = false;
  begin();
  sweep(
      [&] {
        committed = false;
        MapArchive archive(path, ArchiveAccess::write);
        putAll(both, archive);
        archive.commit({});
        committed = true;
        archive.close();
      },
      [&] {
        {
          const MapArchive archive(path, ArchiveAccess::read);
          const bool has_both = committed || archive.state().blocks == both.size();
          expectHolds(archive, has_both ? both : first);
        }
        begin();
      });
}

} // namespace pcl_semantic
