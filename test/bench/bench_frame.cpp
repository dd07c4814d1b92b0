// SPDX-License-Identifier: BSD-3-Clause

// Time of a frame by stage, beside the paper's table of times (an i7-4790; its network
// ran on a GPU and is not counted), with default parameters and in the paper's window,
// and frames per second against the 10 Hz of KITTI's cameras. The input is sequence 07
// with a network, or the synthetic street with precomputed labels. Medians over frames;
// prints a table in Markdown. The totals are SemanticMapper::process, including the
// time between stages, and the process pcl_semantic_map.

#include "bench/kitti_map.h"
#include "bench/median.h"
#include "bench/ratio.h"
#include "support/known_frames.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"
#include "synthesize/labels.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/npy_file.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <array>
#include <csignal>
#include <map>
#include <stdexcept>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using namespace pcl_semantic;

constexpr int street_frames = 10;
constexpr double camera_rate = 10.0; // [Hz]
// Required frames per second relative to that rate; the rest is left for a network.
constexpr double process_target = 1.6, program_target = 1.2;
constexpr double load_target = 0.5; // of the speed, with one processor kept busy
constexpr double objects_target = 1.0 / 1.2; // a frame with objects: a fifth more

// A sequence from any source.
struct Frames {
  std::string name;
  StereoCamera camera;
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  std::vector<StereoFrame> frames;
  std::vector<LabelDistributions> labels; // per frame
  double network = 0.0;                   // seconds per frame; 0 = no network
};

double
quantile(std::vector<double> values, double fraction)
{
  std::sort(values.begin(), values.end());
  return values[std::size_t(fraction * double(values.size() - 1) + 0.5)];
}

std::string
sourcePath(const std::string& name)
{
  return std::string(PCL_SEMANTIC_SOURCE_DIR) + "/data/" + name;
}

LabelSet
labelSet()
{
  return readLabelSet(sourcePath("label_sets/kitti11.yaml"));
}

Frames
kittiFrames(const std::string& data)
{
  const KittiSequence sequence(data + "/kitti/07");
  const auto network = kittiNetwork();
  Frames result;
  result.name = "KITTI 07";
  result.camera = sequence.camera();
  result.T_camera0_camera = sequence.T_camera0_camera();
  std::vector<double> seconds;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    result.frames.push_back(sequence.frame(i));
    seconds.push_back(secondsOf([&] {
      result.labels.push_back(
          network->predict(result.frames.back().left, result.frames.back().number));
    }));
  }
  result.network = median(seconds);
  return result;
}

Frames
streetFrames()
{
  const SyntheticRenderer street(SyntheticScene(1, street_frames), 1241, 376);
  Frames result;
  result.name = "the synthetic street";
  result.camera = street.camera();
  for (int i = 0; i < street_frames; ++i) {
    const SyntheticView view = street.render(i);
    result.frames.push_back({{i, 0.1 * i}, view.left, view.right});
    result.labels.push_back(syntheticDistributions(view, 1));
  }
  return result;
}

// Median seconds of the paper's stages, and of the whole process().
struct Stages {
  double disparity, pose, superpixels, occupancy, crf;
  double objects = 0.0; // not in the paper
  double process = 0.0, process_percentile_95 = 0.0;

  double
  sum() const
  {
    return disparity + pose + superpixels + occupancy + crf + objects;
  }
};

Stages
mapAll(const Frames& data, MapperConfig config, CRFModelType crf)
{
  config.crf = crf;
  config.cliques = "superpixel";
  SemanticMapper mapper(
      labelSet(), config,
      std::make_unique<StereoOdometry>(data.camera, data.T_camera0_camera), data.camera,
      std::make_unique<KnownLabels>(
          [&, next = std::size_t(0)](int) mutable { return data.labels.at(next++); }));
  std::map<std::string, std::vector<double>> seconds; // by the mapper's stages
  for (const StereoFrame& frame : data.frames) {
    MappedFrame mapped;
    seconds["process"].push_back(secondsOf([&] { mapped = mapper.process(frame); }));
    for (const auto& [stage, each] : mapped.times.seconds())
      seconds[stage].push_back(each);
    // Measured separately, because the mapper makes them within its CRF.
    const SlicParameters& slic = config.clique_parameters.superpixel.slic;
    seconds["superpixels"].push_back(
        secondsOf([&] { slicSuperpixels(frame.left, slic); }));
  }
  const auto of = [&](const char* stage) { return median(seconds.at(stage)); };
  const double superpixels =
      crf == CRFModelType::hierarchical ? of("superpixels") : 0.0;
  return {of("stereo"),
          of("pose"),
          superpixels,
          of("cloud") + of("map") + of("voxels"),
          of("crf") - superpixels,
          config.things ? of("things") : 0.0,
          of("process"),
          quantile(seconds.at("process"), 0.95)};
}

const Stages paper_hierarchical = {0.416, 0.102, 0.115, 0.295, 0.53};
const Stages paper_dense = {0.416, 0.102, 0.0, 0.295, 0.38};

// Columns of the table: default parameters, the paper's window, the paper.
using Columns = std::array<Stages, 3>;

template <typename Figure>
void
printRow(const char* name, const Columns& columns, const Figure& figure)
{
  std::printf("| %s |", name);
  for (const Stages& stages : columns)
    std::printf(" %.3f |", figure(stages));
  std::printf("\n");
}

void
printTable(const Frames& data, const Columns& hierarchical, const Columns& dense)
{
  std::printf("| seconds a frame, %s | defaults, 84 m | paper's window, 25 m | paper "
              "|\n|---|---:|---:|---:|\n",
              data.name.c_str());
  const auto row = [&](const char* name, double Stages::*stage) {
    printRow(name, hierarchical, [&](const Stages& each) { return each.*stage; });
  };
  row("dense disparity", &Stages::disparity);
  row("state estimation (odometry)", &Stages::pose);
  row("superpixels", &Stages::superpixels);
  row("occupancy mapping, with colours and labels", &Stages::occupancy);
  row("hierarchical CRF", &Stages::crf);
  printRow("dense CRF", dense, [](const Stages& each) { return each.crf; });
  row("objects", &Stages::objects);
  const auto sum = [](const Stages& each) { return each.sum(); };
  printRow("**all, hierarchical**", hierarchical, sum);
  printRow("**all, dense**", dense, sum);
  const auto rate = [](const Stages& each) { return 1.0 / each.sum(); };
  printRow("**frames a second, hierarchical** (the camera: 10)", hierarchical, rate);
  printRow("**frames a second, dense**", dense, rate);
  if (data.network > 0.0)
    std::printf("| network (the paper's on a GPU, not counted) | %.3f | %.3f | |\n",
                data.network, data.network);
  std::printf("\n");
  for (const auto& [name, stages] :
       {std::pair("hierarchical", hierarchical), std::pair("dense", dense)}) {
    const std::string start = std::string("frame_") + name;
    printRatio(start + "_vs_10_hz", rate(stages[0]) / camera_rate, 1);
    printRatio(start + "_in_papers_window_vs_10_hz", rate(stages[1]) / camera_rate, 1);
    printRatio(start + "_in_papers_window_vs_paper", sum(stages[2]) / sum(stages[1]),
               1);
  }
}

// A child process that keeps a processor busy during the object's lifetime.
class Load {
public:
  Load() : process_(fork())
  {
    if (process_ < 0)
      throw std::runtime_error("there cannot be another process");
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL); // also if this process is killed
      for (volatile unsigned turns = 0;; turns = turns + 1)
        ;
    }
  }
  ~Load()
  {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

private:
  pid_t process_;
};

void
printProcess(const Stages& stages, const Stages& without_objects,
             const Stages& under_load)
{
  std::printf("SemanticMapper::process, defaults, hierarchical: median %.3f s, 95th "
              "percentile %.3f s\n",
              stages.process, stages.process_percentile_95);
  printRatio("frame_process_vs_10_hz", 1.0 / stages.process / camera_rate,
             process_target);
  std::printf("without objects: median %.3f s, 95th percentile %.3f s\n",
              without_objects.process, without_objects.process_percentile_95);
  printRatio("frame_without_objects_vs_with", without_objects.process / stages.process,
             objects_target);
  std::printf("with one processor kept busy: median %.3f s, 95th percentile %.3f s\n",
              under_load.process, under_load.process_percentile_95);
  printRatio("frame_process_under_load", stages.process / under_load.process,
             load_target);
}

// Runs the program with stored labels, including their decoding, and only the map as
// output. Runs of two lengths separate the frames from start and end.
void
printProgram(const Frames& data, const std::string& sequence)
{
  const TemporaryFolder folder;
  for (std::size_t i = 0; i < data.labels.size(); ++i) {
    const cv::Mat& image = data.frames[i].left;
    writeNpy(folder.path(frameFileName(data.frames[i].number, ".npy")), image.rows,
             image.cols, data.labels[i].classes(), data.labels[i].column(0),
             NpyType::float16);
  }
  const auto secondsFor = [&](std::size_t frames) {
    return medianSeconds(3, [&] {
      const ToolResult result =
          runTool("map " + sequence + " --labels " + folder.path() +
                      " --map-only --crf hierarchical --cliques superpixel --quiet "
                      "--frames 0:" +
                      std::to_string(frames) + " --output " + folder.path("map"),
                  kStartedAnew);
      if (result.code != 0) {
        std::printf("%s", result.text.c_str());
        std::exit(1);
      }
    });
  };
  const std::size_t frames = data.frames.size(), few = 2;
  const double all = secondsFor(frames), begin_and_end = secondsFor(few);
  const double rate = double(frames - few) / (all - begin_and_end);
  std::printf(
      "pcl_semantic_map: %zu frames in %.2f s, %zu in %.2f s: %.1f more frames a "
      "second\n",
      frames, all, few, begin_and_end, rate);
  printRatio("frame_program_vs_10_hz", rate / camera_rate, program_target);
}

} // namespace

int
main()
{
  const std::string folder = realDataFolder();
  setNumberOfThreads(0);
  const Frames data = folder.empty() ? streetFrames() : kittiFrames(folder);
  MapperConfig paper;
  readMapperConfig(sourcePath("presets/paper_dense.yaml"), paper);
  const Stages hierarchical = mapAll(data, MapperConfig(), CRFModelType::hierarchical);
  printTable(data,
             {hierarchical, mapAll(data, paper, CRFModelType::hierarchical),
              paper_hierarchical},
             {mapAll(data, MapperConfig(), CRFModelType::dense),
              mapAll(data, paper, CRFModelType::dense), paper_dense});
  MapperConfig without_objects;
  without_objects.things = false;
  const auto under_load = [&] {
    const Load load;
    return mapAll(data, MapperConfig(), CRFModelType::hierarchical);
  };
  printProcess(hierarchical, mapAll(data, without_objects, CRFModelType::hierarchical),
               under_load());
  if (!folder.empty())
    printProgram(data, folder + "/kitti/07");
  return 0;
}
