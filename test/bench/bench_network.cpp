// SPDX-License-Identifier: BSD-3-Clause

// Seconds of a segmentation network for an image of KITTI, by each engine in the
// library, with all threads and with one; median of eight runs, in Markdown. Ratios are
// OpenCV's time divided by ONNX Runtime's.

#include "bench/kitti_map.h"
#include "bench/ratio.h"

#include <pcl_semantic/core/threads.h>

#include <opencv2/core/version.hpp>

#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace pcl_semantic;

struct Network {
  std::string name;
  int width, height; // of its images [px]
};

const Network networks[] = {{"espnetv2_s1.0_city_1120x320_halfres", 1120, 320},
                            {"espnetv2_s2.0_city_1120x320_halfres", 1120, 320},
                            {"espnetv2_s2.0_city_1280x480_halfres", 1280, 480}};

double
secondsAFrame(const Network& network, NetworkEngine engine, int threads)
{
  const ThreadScope scope(threads);
  const std::string data = realDataFolder();
  NetworkDescription description = kittiNetworkDescription();
  description.input_width = network.width;
  description.input_height = network.height;
  NetworkPredictor predictor(description, readLabelSet(description.label_set_path),
                             data + "/nets/" + network.name + ".onnx", engine);
  const KittiSequence sequence(data + "/kitti/07");
  const StereoFrame frame = sequence.frame(0);
  return medianSeconds(8, [&] { predictor.predict(frame.left, frame.number); });
}

} // namespace

int
main()
{
  if (realDataFolder().empty()) {
    std::printf("PCL_SEMANTIC_DATA is not set: there is no network to try\n");
    return 0;
  }
  const bool has_both = networkEngines().size() > 1;
  std::printf("| network | OpenCV %s, all threads | one |%s\n|---|---:|---:|%s\n",
              CV_VERSION, has_both ? " ONNX Runtime, all threads | one |" : "",
              has_both ? "---:|---:|" : "");
  std::vector<double> ratios;
  for (const Network& network : networks) {
    const auto seconds = [&](NetworkEngine engine, int threads) {
      const double time = secondsAFrame(network, engine, threads);
      std::printf(" %.3f |", time);
      return time;
    };
    std::printf("| %s |", network.name.c_str());
    const double opencv = seconds(NetworkEngine::opencv, 0);
    seconds(NetworkEngine::opencv, 1);
    if (has_both) {
      ratios.push_back(opencv / seconds(NetworkEngine::onnx_runtime, 0));
      seconds(NetworkEngine::onnx_runtime, 1);
    }
    std::printf("\n");
  }
  for (std::size_t i = 0; i < ratios.size(); ++i)
    printRatio("network_" + networks[i].name, ratios[i], 1.5);
  return 0;
}
