// SPDX-License-Identifier: BSD-3-Clause

// A drive of many hours: repetitions of the synthetic street one after the other,
// 20,000 frames and 17 km with an archive, 5,000 without. Prints a table in Markdown, a
// row per thousand frames, and finally the changes of memory, files, archive and time
// since the second thousand. The time of a frame is compared with a fresh run for the
// same frame of the street at the same moment, because the speed of machines varies by
// more than the expected effect.
//
//   bench_soak [FRAMES [none|archive]]

#include "bench/median.h"
#include "support/known_frames.h"
#include "support/temporary_folder.h"
#include "synthesize/labels.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/pipeline/mapping_archive.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <unistd.h>

using namespace pcl_semantic;

namespace {

constexpr int kStreet = 100; // frames of the repeated street
constexpr int kEvery = 1000; // frames per row

double
residentMegabytes()
{
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0; // pages
  file >> all >> resident;
  return resident * double(::sysconf(_SC_PAGESIZE)) / 1e6;
}

int
openFiles()
{
  namespace fs = std::filesystem;
  return int(
      std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}

// Repetitions of the street, one after the other.
class EndlessStreet {
public:
  explicit EndlessStreet(const SyntheticRenderer& renderer) : renderer_(renderer)
  {
    for (int i = 0; i < kStreet; ++i) {
      views_.push_back(renderer.render(i));
      labels_.push_back(syntheticDistributions(views_.back(), 3));
    }
  }

  Eigen::Isometry3d
  pose(int number) const
  {
    const Eigen::Vector3d length =
        renderer_.pose(kStreet - 1).translation() - renderer_.pose(0).translation();
    return Eigen::Translation3d(length * (number / kStreet)) *
           renderer_.pose(number % kStreet);
  }

  const LabelDistributions&
  labels(int number) const
  {
    return labels_[std::size_t(number % kStreet)];
  }

  StereoFrame
  frame(int number) const
  {
    const SyntheticView& view = viewOf(number);
    return {{number, 0.1 * number}, view.left, view.right};
  }

private:
  const SyntheticView&
  viewOf(int number) const
  {
    return views_[std::size_t(number % kStreet)];
  }

  const SyntheticRenderer& renderer_;
  std::vector<SyntheticView> views_;
  std::vector<LabelDistributions> labels_;
};

// One run over the endless street.
class Drive {
public:
  Drive(const SyntheticRenderer& renderer, const EndlessStreet& street, int frames,
        bool has_archive)
      : street_(street)
  {
    MappingRun run;
    run.label_set =
        readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
    run.config.map.voxel_size = 0.2;
    run.config.map.max_range = 20.0;
    run.camera = renderer.camera();
    run.frames.resize(std::size_t(frames));
    std::iota(run.frames.begin(), run.frames.end(), 0);
    const std::string path = has_archive ? folder_.path("map") : "";
    archive_ =
        std::make_unique<MappingArchive>(MappingArchive::Options{path, 10, false}, run);
    mapper_ = std::make_unique<SemanticMapper>(
        run.label_set, run.config,
        std::make_unique<KnownPoses>([&](int number) { return street.pose(number); }),
        renderer.camera(), std::make_unique<KnownLabels>([&](int number) {
          return street.labels(number);
        }),
        archive_->store());
  }

  // Returns the seconds of the frame.
  double
  process(int number)
  {
    const auto begin = std::chrono::steady_clock::now();
    const auto frame = street_.frame(number);
    archive_->add(frame, mapper_->process(frame), *mapper_);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
        .count();
  }

  double
  archiveMegabytes() const
  {
    return double(std::filesystem::file_size(folder_.path("map"))) / 1e6;
  }

  double
  thousandBlocks() const
  {
    double blocks = 0.0;
    mapper_->map().forEachBlock(
        [&](const VoxelIndex&, const VoxelBlock&) { blocks += 1e-3; });
    return blocks;
  }

private:
  const EndlessStreet& street_;
  TemporaryFolder folder_;
  std::unique_ptr<MappingArchive> archive_;
  std::unique_ptr<SemanticMapper> mapper_;
};

struct Row {
  double memory; // resident [MB]
  double files;  // open ones
  double kept;   // archive [MB], or blocks in memory [thousands]
  double ratio;  // of a frame's time to that of a fresh run
};

// Processes the frames [begin, end), the last kStreet of them paired with a fresh
// run's. Returns the median ratio of their times, and prints the median time.
double
driveOn(Drive& drive, int begin, int end, Drive& fresh)
{
  for (int i = 0; i < kStreet; ++i)
    fresh.process(i);
  std::vector<double> seconds, ratios;
  for (int i = begin; i < end; ++i) {
    seconds.push_back(drive.process(i));
    if (i >= end - kStreet)
      ratios.push_back(seconds.back() / fresh.process(kStreet + i % kStreet));
  }
  std::cout << "| " << end << " | " << 1e3 * median(seconds);
  return median(ratios);
}

void
soak(const SyntheticRenderer& renderer, const EndlessStreet& street, int frames,
     bool has_archive)
{
  std::cout
      << std::fixed << std::setprecision(1) << "\n"
      << (has_archive ? "With an archive" : "Without one") << "\n\n"
      << "| frames | median frame [ms] | to a new run's | memory [MB] | open files | "
      << (has_archive ? "archive [MB]" : "blocks [thousands]")
      << " |\n|---:|---:|---:|---:|---:|---:|" << std::endl;
  Drive drive(renderer, street, frames, has_archive);
  std::vector<Row> rows;
  for (int end = kEvery; end <= frames; end += kEvery) {
    Row row;
    {
      Drive fresh(renderer, street, 2 * kStreet, has_archive);
      row.ratio = driveOn(drive, end - kEvery, end, fresh);
    }
    row.memory = residentMegabytes();
    row.files = openFiles();
    row.kept = has_archive ? drive.archiveMegabytes() : drive.thousandBlocks();
    std::cout << " | " << std::setprecision(3) << row.ratio << std::setprecision(1)
              << " | " << row.memory << " | " << int(row.files) << " | " << row.kept
              << " |" << std::endl;
    rows.push_back(row);
  }
  if (rows.size() < 3)
    return;
  const Row &first = rows[1], &last = rows.back(); // the second thousand is warm
  const double thousands = double(rows.size());
  std::cout << std::setprecision(3) << "\nsince the second thousand: open files "
            << last.files / first.files << ", time " << last.ratio / first.ratio;
  if (has_archive)
    std::cout << ", memory " << last.memory / first.memory << ", archive a frame "
              << (last.kept / thousands) / (first.kept / 2.0);
  else
    std::cout << ", memory " << (last.memory - first.memory) / (last.kept - first.kept)
              << " KB a block";
  std::cout << std::endl;
}

} // namespace

int
main(int argc, char** argv)
{
  const int frames = argc > 1 ? std::atoi(argv[1]) : 20000;
  const std::string kind = argc > 2 ? argv[2] : "";
  const SyntheticRenderer renderer(SyntheticScene(3, kStreet), 208, 64);
  const EndlessStreet street(renderer);
  if (kind != "none")
    soak(renderer, street, frames, true);
  if (kind != "archive")
    soak(renderer, street, std::min(frames, 5000), false);
}
