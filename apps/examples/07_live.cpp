// SPDX-License-Identifier: BSD-3-Clause

// 07: frames are pushed into a SemanticMapper while another thread reads the map.
//
// One thread may write (process, finish) while any number of others call const
// functions of map(). Each call sees the map between two changes. A frame makes two
// changes: its scan, and the result of the CRF. Two calls may see different frames. For
// a consistent frame, use the callback's arguments, which stay constant.

#include "synthesize/sequence.h"

#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <condition_variable>
#include <future>
#include <iostream>

using namespace pcl_semantic;

namespace {

class StreetLabels : public LabelPredictor { // instead of a network
public:
  explicit StreetLabels(const SyntheticSequence& street) : street_(street) {}

  LabelDistributions
  predict(const cv::Mat& /*image*/, int frame) override
  {
    return street_.labels(std::size_t(frame));
  }

private:
  const SyntheticSequence& street_;
};

// The newest snapshot. A slow reader misses snapshots and blocks no other thread.
struct Exchange {
  std::mutex mutex;
  std::condition_variable changed;
  std::shared_ptr<const VoxelCloud> newest; // null = taken
  bool is_over = false;                     // no more will follow

  void
  put(std::shared_ptr<const VoxelCloud> voxels)
  {
    const std::lock_guard<std::mutex> lock(mutex);
    is_over = !voxels;
    newest = is_over ? newest : voxels;
    changed.notify_one();
  }
};

void
watch(Exchange& exchange, const SemanticVoxelMap& map)
{
  for (;;) {
    std::unique_lock<std::mutex> lock(exchange.mutex);
    exchange.changed.wait(lock, [&] { return exchange.newest || exchange.is_over; });
    const auto voxels = std::move(exchange.newest);
    lock.unlock(); // the snapshot is ours
    if (!voxels)
      return;
    const Eigen::Vector3d low(5.0, -2.0, -2.0), high(20.0, 2.0, 0.0); // ahead [m]
    std::cout << "snapshot of " << voxels->size() << " voxels; the live map knows "
              << map.states({low, high}).size() << " there" << std::endl;
  }
}

} // namespace

int
main(int, char** argv)
try {
  const LabelSet classes = readLabelSet(findDataFile("label_sets/kitti11.yaml"));
  const SyntheticSequence street(4, 310, 94);
  SemanticMapper mapper(
      classes, MapperConfig(),
      std::make_unique<StereoOdometry>(street.camera(), street.T_camera0_camera()),
      street.camera(), std::make_unique<StreetLabels>(street));
  Exchange exchange;
  mapper.setCallback([&](const MappedFrame& mapped, const SemanticVoxelMap&) {
    exchange.put(std::make_shared<VoxelCloud>(mapped.voxels));
  });
  const auto reader =
      std::async(std::launch::async, [&] { watch(exchange, mapper.map()); });
  const std::shared_ptr<void> end(nullptr, [&](void*) { exchange.put(nullptr); });
  for (std::size_t i = 0; i < street.size(); ++i)
    mapper.process(street.frame(i)); // in the order of a camera
  mapper.finish();
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
