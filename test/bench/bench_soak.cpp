// SPDX-License-Identifier: BSD-3-Clause

// A drive of many hours: the synthetic street again and again, each time behind the
// last one, 20,000 frames and 17 km, with an archive and without. Prints, every
// thousand frames, memory, open files, size of the archive and time of a frame as a
// table in Markdown, and at the end how far each has moved since the second thousand.
// The number of frames may be given.

#include "support/temporary_folder.h"

#include <pcl_semantic/dataset/synthetic_labels.h>
#include <pcl_semantic/dataset/synthetic_renderer.h>
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
#include <vector>

#include <unistd.h>

using namespace pcl_semantic;

namespace {

constexpr int kStreet = 100; // frames of the street that is repeated
constexpr int kEvery = 1000; // frames a row

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

// The street behind the street, and so on.
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

class Poses : public PoseSource {
public:
  explicit Poses(const EndlessStreet& street) : street_(street) {}

  Eigen::Isometry3d
  pose(const SensorFrame& frame) override
  {
    return street_.pose(timeOf(frame).number);
  }

private:
  const EndlessStreet& street_;
};

class Labels : public LabelPredictor {
public:
  explicit Labels(const EndlessStreet& street) : street_(street) {}

  LabelDistributions
  predict(const StereoFrame& frame) override
  {
    return street_.labels(frame.number);
  }

private:
  const EndlessStreet& street_;
};

struct Row {
  double memory, files, archive, seconds;
};

double
median(std::vector<double> values)
{
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void
drive(const SyntheticRenderer& renderer, const EndlessStreet& street, int frames,
      bool has_archive)
{
  const TemporaryFolder folder;
  MappingRun run;
  run.label_set = readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
  run.config.map.voxel_size = 0.2;
  run.config.map.max_range = 20.0;
  run.camera = renderer.camera();
  for (int i = 0; i < frames; ++i)
    run.frames.push_back(i);
  MappingArchive archive({has_archive ? folder.path("map") : "", 10, false}, run);
  SemanticMapper mapper(run.label_set, run.config, std::make_unique<Poses>(street),
                        renderer.camera(), std::make_unique<Labels>(street),
                        archive.store());
  std::cout << "\n"
            << (has_archive ? "With an archive" : "Without one") << "\n\n"
            << "| frames | memory [MB] | open files | archive [MB] | median frame [ms] "
               "|\n|---:|---:|---:|---:|---:|\n";
  std::vector<Row> rows;
  std::vector<double> seconds;
  for (int i = 0; i < frames; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    archive.add(mapper.process(street.frame(i)), mapper);
    seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
            .count());
    if ((i + 1) % kEvery != 0)
      continue;
    const double size =
        has_archive ? double(std::filesystem::file_size(folder.path("map"))) / 1e6
                    : 0.0;
    rows.push_back({residentMegabytes(), double(openFiles()), size, median(seconds)});
    const Row& row = rows.back();
    std::cout << std::fixed << std::setprecision(1) << "| " << i + 1 << " | "
              << row.memory << " | " << int(row.files) << " | " << row.archive << " | "
              << 1e3 * row.seconds << " |" << std::endl;
    seconds.clear();
  }
  if (rows.size() < 3)
    return;
  const Row &first = rows[1], &last = rows.back(); // the second thousand is warm
  std::cout << "\nsince the second thousand: memory " << last.memory / first.memory
            << ", open files " << last.files / first.files << ", time "
            << last.seconds / first.seconds;
  if (has_archive)
    std::cout << ", archive a frame "
              << (last.archive / double(rows.size())) / (first.archive / 2.0);
  std::cout << std::endl;
}

} // namespace

int
main(int argc, char** argv)
{
  const int frames = argc > 1 ? std::atoi(argv[1]) : 20000;
  const SyntheticRenderer renderer(SyntheticScene(3, kStreet), 208, 64);
  const EndlessStreet street(renderer);
  drive(renderer, street, frames, true);
  drive(renderer, street, std::min(frames, 5000), false);
}
