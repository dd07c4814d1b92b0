// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "cameras.h"
#include "core/fail.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/dataset/rgbd_frame.h>
#include <pcl_semantic/io/map_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/map/map_doubts.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>
#include <pcl_semantic/stereo/pair_check.h>
#include <pcl_semantic/things/plane_summary.h>

#include <pcl/common/io.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <set>
#include <type_traits>
#include <variant>

namespace pcl_semantic::python {

namespace {

py::dict
dictOf(const ScanCounts& counts)
{
  py::dict result;
  result["points"] = counts.points;
  result["rays"] = counts.rays;
  result["invalid"] = counts.invalid;
  result["sky"] = counts.sky;
  result["hit_voxels"] = counts.hit_voxels;
  return result;
}

// Functions that read a map, for both kinds of maps.

template <typename Bound>
py::dict
voxels(const Bound& bound)
{
  return python::dictOf(released([&] { return bound.occupied(); }));
}

template <typename Bound>
py::array_t<std::uint8_t>
labels(const Bound& bound, const py::object& given_points)
{
  const py::array any = numbersOf(given_points);
  const Array<double> points(any);
  requireShape(points, "points", kAny, 3);
  warnOfSteps(any,
              Eigen::Map<const Eigen::Matrix3Xd>(points.data(), 3, points.shape(0)),
              bound.map().parameters().voxel_size, "points");
  std::vector<Eigen::Vector3d> places;
  places.reserve(std::size_t(points.shape(0)));
  for (py::ssize_t i = 0; i < points.shape(0); ++i)
    places.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
  const auto found = released([&] { return bound.map().labels(places); });
  return py::array_t<std::uint8_t>(py::ssize_t(found.size()), found.data());
}

template <typename Bound>
void
write(const Bound& bound, const Path& path, bool class_colours)
{
  requirePcdName(path);
  const SemanticVoxelMap& map = bound.map();
  released([&] {
    writeVoxelCloud(path, bound.withPlanes(), map.labelSet(),
                    class_colours ? VoxelColour::classes : VoxelColour::measured);
  });
}

template <typename Bound>
void
save(const Bound& bound, const Path& path)
{
  released([&] { saveMap(bound.map(), path, bound.objects()); });
}

template <typename Bound>
void
bindReading(py::class_<Bound>& bound)
{
  bound
      .def("voxels", &voxels<Bound>,
           "The occupied voxels: points [m, world], colours, labels, probabilities,\n"
           "observations, indices; an entry a voxel. Of SemanticMapper also objects:\n"
           "numbers, 0 = none.")
      .def("labels", &labels<Bound>, py::arg("points"),
           "Labels of points (N x 3, world [m]); 0 = not occupied, not in the window.")
      .def("write", &write<Bound>, py::arg("path"), py::arg("class_colours") = false,
           "Writes the occupied voxels as a .pcd file.")
      .def("save", &save<Bound>, py::arg("path"),
           "Writes the whole map into a new archive.");
}

// Parameters of the pipeline that a plain map does not use.
std::vector<std::string>
unreadByMap(MapperConfig& config)
{
  const auto isOfMap = [&](const auto* value) {
    const auto* const place = reinterpret_cast<const char*>(value);
    const auto* const first = reinterpret_cast<const char*>(&config.map);
    return (place >= first && place < first + sizeof config.map) ||
           place == reinterpret_cast<const char*>(&config.threads);
  };
  std::vector<std::string> unread;
  for (const ConfigParameter& parameter : parametersOf(config))
    if (!std::visit(
            [&](const auto& value) {
              if constexpr (std::is_pointer_v<std::decay_t<decltype(value)>>)
                return isOfMap(value);
              else // a choice
                return parameter.name == "pixel_fusion" || parameter.name == "clearing";
            },
            parameter.value))
      unread.push_back(parameter.name);
  return unread;
}

// Only one thread may write a map. Python's threads, which run while the interpreter
// lock is released, wait here.
class Map {
public:
  explicit Map(std::unique_ptr<SemanticVoxelMap> map) : map_(std::move(map)) {}

  Map(const Path& label_set, const py::kwargs& values)
  {
    MapperConfig config;
    setParameters(parametersOf(config), values);
    refuseUnread(values, unreadByMap(config),
                 "in a SemanticVoxelMap: it is for SemanticMapper");
    config.validate();
    warnOf(doubtsOf(config.map));
    map_ = std::make_unique<SemanticVoxelMap>(labelSetOf(label_set), config.map);
    map_->setNumberOfThreads(config.threads);
  }

  const SemanticVoxelMap&
  map() const
  {
    return *map_;
  }

  VoxelCloud
  occupied() const
  {
    return map_->occupiedEverywhere();
  }

  VoxelCloud
  withPlanes() const
  {
    return occupied(); // as an export of the program
  }

  std::optional<MapObjects>
  objects() const
  {
    return {};
  }

  py::dict
  integrate(const py::object& points, const py::object& pose,
            const py::object& probabilities, const py::object& given_colours)
  {
    const auto colours = maybeIntegersOf<std::uint8_t>(given_colours, "colours");
    const auto cloud = scanOf(points, colours);
    const Eigen::Isometry3d T_world_sensor =
        poseOf(pose, map_->parameters().voxel_size);
    const LabelDistributions distributions =
        distributionsOf(probabilities, py::ssize_t(cloud->size()));
    return dictOf(released([&] {
      const std::lock_guard<std::mutex> lock(writing_);
      if (colours)
        return map_->integrate(*cloud, T_world_sensor, distributions);
      pcl::PointCloud<pcl::PointXYZ> positions;
      pcl::copyPointCloud(*cloud, positions);
      return map_->integrate(positions, T_world_sensor, distributions);
    }));
  }

  void
  moveWindow(const Array<double>& centre)
  {
    requireShape(centre, "coordinates of the centre", 3);
    const Eigen::Vector3d place(centre.at(0), centre.at(1), centre.at(2));
    released([&] {
      const std::lock_guard<std::mutex> lock(writing_);
      map_->moveWindow(place);
    });
  }

private:
  std::unique_ptr<SemanticVoxelMap> map_;
  std::mutex writing_;
};

struct GivenPose : PoseSource {
  Eigen::Isometry3d T_world_sensor = Eigen::Isometry3d::Identity();

  Eigen::Isometry3d
  pose(const SensorFrame&) override
  {
    return T_world_sensor;
  }
};

struct GivenLabels : LabelPredictor {
  LabelDistributions distributions;

  LabelDistributions
  predict(const cv::Mat&, int) override
  {
    return distributions;
  }
};

class Mapper {
public:
  Mapper(const Path& label_set, const std::optional<std::vector<double>>& camera,
         const py::kwargs& values)
  {
    MapperConfig config;
    setParameters(parametersOf(config), values);
    config.validate();
    refuseUnreadOfCRF(values, nameOf(config.crf), config.cliques);
    refuseUnread(values, {"label_confidence"}, "beside probabilities");
    if (!camera)
      refuseUnread(values,
                   {"stereo", "disparities", "max_deviation", "deviation_scale",
                    "min_hit_ratio", "network_every"},
                   "without camera=");
    warnOf(doubtsOf(config.map));
    auto poses = std::make_unique<GivenPose>();
    pose_ = poses.get();
    std::unique_ptr<GivenLabels> labels;
    if (camera) {
      camera_ = cameraOf(*camera);
      warnOf(doubtsOf(*camera_));
      labels = std::make_unique<GivenLabels>();
      labels_ = labels.get();
    }
    finds_planes_ = config.things;
    mapper_ = std::make_unique<SemanticMapper>(
        labelSetOf(label_set), config, std::move(poses), camera_, std::move(labels));
  }

  const SemanticVoxelMap&
  map() const
  {
    return mapper_->map();
  }

  VoxelCloud
  occupied() const
  {
    const std::lock_guard<std::mutex> lock(writing_);
    VoxelCloud voxels = map().occupiedEverywhere();
    if (mapper_->objects())
      voxels.objects = mapper_->objects()->numbers(voxels);
    return voxels;
  }

  VoxelCloud
  withPlanes() const
  {
    VoxelCloud voxels = occupied();
    if (finds_planes_)
      voxels.planes =
          findPlanes(voxels.cloud, voxels.voxel_size, voxels.origin).numbers;
    return voxels;
  }

  std::optional<MapObjects>
  objects() const
  {
    const std::lock_guard<std::mutex> lock(writing_);
    return mapper_->objects() ? std::optional(mapper_->objects()->objects())
                              : std::nullopt;
  }

  py::dict
  process(const py::object& points, const py::object& pose,
          const py::object& probabilities, const py::object& given_colours)
  {
    const auto colours = maybeIntegersOf<std::uint8_t>(given_colours, "colours");
    const auto cloud = scanOf(points, colours);
    CloudFrame frame;
    frame.cloud.reset(new pcl::PointCloud<pcl::PointXYZRGB>);
    pcl::copyPointCloud(*cloud, *frame.cloud);
    if (camera_ && cloud->size() == std::size_t(camera_->width) * camera_->height) {
      frame.cloud->width = std::uint32_t(camera_->width);
      frame.cloud->height = std::uint32_t(camera_->height);
    }
    frame.distributions = distributionsOf(probabilities, py::ssize_t(cloud->size()));
    frame.has_colour = colours.has_value();
    return processFrame(frame, pose, [] {});
  }

  py::dict
  processPair(const py::object& left, const py::object& right, const py::object& pose,
              const py::object& probabilities)
  {
    if (!camera_)
      badParameter("stereo pairs need the camera: SemanticMapper(camera=...)");
    requireNoFork();
    StereoFrame frame;
    frame.left = imageOf(left, *camera_, "the left image");
    frame.right = imageOf(right, *camera_, "the right image");
    if (probabilities.is_none())
      badParameter("probabilities are None, expected those of the left image; only "
                   "process() takes clouds without probabilities");
    const LabelDistributions distributions =
        distributionsOf(probabilities, py::ssize_t(camera_->width) * camera_->height);
    warnOfFault(checkPair(frame.left, frame.right));
    return processFrame(frame, pose, [&] { labels_->distributions = distributions; });
  }

  py::dict
  processRgbd(const py::object& image, const py::object& depths, const py::object& pose,
              const py::object& probabilities)
  {
    if (!camera_)
      badParameter("RGB-D frames need the camera: SemanticMapper(camera=...)");
    const cv::Mat pixels = imageOf(image, *camera_, "the image");
    const py::array given = numbersOf(depths);
    if (given.dtype().kind() != 'f')
      badParameter("depths are no floats, expected metres: depths / 1000.0 if they are "
                   "millimetres");
    const Array<double> metres(given);
    requireShape(metres, "depths", camera_->height, camera_->width);
    cv::Mat1d values(camera_->height, camera_->width);
    std::copy_n(metres.data(), metres.size(), values.begin());
    const LabelDistributions distributions =
        distributionsOf(probabilities, py::ssize_t(camera_->width) * camera_->height);
    return processFrame(rgbdFrameOf(pixels, values, *camera_), pose,
                        [&] { labels_->distributions = distributions; });
  }

  void
  finish()
  {
    released([&] {
      const std::lock_guard<std::mutex> lock(writing_);
      mapper_->finish();
    });
  }

private:
  // Warns once of each kind of fault, as the programs do.
  void
  warnOfFault(const PairReport& report)
  {
    if (report.fault != PairFault::none && faults_.insert(report.fault).second)
      warn("frame " + std::to_string(frames_.load()) + ": " + report.reason);
  }

  // Waits without the interpreter lock, because the thread it waits for needs it to
  // end. \param[in] prepare is called when this frame may write the map
  template <typename Frame, typename Prepare>
  py::dict
  processFrame(Frame frame, const py::object& pose, Prepare&& prepare)
  {
    const Eigen::Isometry3d T_world_sensor =
        poseOf(pose, map().parameters().voxel_size);
    MappedFrame mapped = released([&] {
      const std::lock_guard<std::mutex> lock(writing_);
      prepare();
      frame.number = frames_;
      pose_->T_world_sensor = T_world_sensor;
      MappedFrame result = mapper_->process(frame);
      ++frames_;
      return result;
    });
    py::dict result = dictOf(mapped.counts);
    result["voxels"] = python::dictOf(std::move(mapped.voxels));
    return result;
  }

  std::optional<StereoCamera> camera_;
  GivenPose* pose_ = nullptr;
  GivenLabels* labels_ = nullptr; // null = no camera
  bool finds_planes_ = false;
  std::unique_ptr<SemanticMapper> mapper_;
  std::atomic<int> frames_ = 0;
  std::set<PairFault> faults_; // already reported ones
  mutable std::mutex writing_;
};

} // namespace

} // namespace pcl_semantic::python

namespace pybind11::detail {

// Refuses objects whose __init__() was not called: their memory is uninitialised.
template <typename Bound> struct made_caster : type_caster_base<Bound> {
  bool
  load(handle source, bool convert)
  {
    if (isinstance_generic(source, typeid(Bound)) &&
        !reinterpret_cast<instance*>(source.ptr())
             ->get_value_and_holder()
             .holder_constructed())
      throw type_error("__init__() of the object was not called");
    return type_caster_base<Bound>::load(source, convert);
  }
};

template <>
struct type_caster<pcl_semantic::python::Map> : made_caster<pcl_semantic::python::Map> {
};

template <>
struct type_caster<pcl_semantic::python::Mapper>
    : made_caster<pcl_semantic::python::Mapper> {};

} // namespace pybind11::detail

namespace pcl_semantic::python {

void
bindMaps(py::module_& module)
{
  py::class_<Map> map(module, "SemanticVoxelMap",
                      "An occupancy map with labels in a window that moves along.");
  map.def(py::init<const Path&, const py::kwargs&>(), py::arg("label_set"),
          "label_set: a file, or the name of an installed one ('kitti11').\nOther "
          "keywords are parameters of pcl_semantic_map: voxel_size=0.2.")
      .def("integrate", &Map::integrate, py::arg("points"), py::arg("pose"),
           py::kw_only(), py::arg("probabilities") = py::none(),
           py::arg("colours") = py::none(),
           "Adds one scan: N x 3 points in the sensor's frame [m] and its pose,\n4 x "
           "4. Returns counts.")
      .def("move_window", &Map::moveWindow, py::arg("centre"),
           "Moves the window without a scan, for labels() of a loaded map.");
  bindReading(map);
  module.def(
      "load_map",
      [](const Path& path) {
        return released([&] { return std::make_unique<Map>(loadMap(path)); });
      },
      py::arg("path"), "The map of an archive, in memory; the file stays as it is.");

  py::class_<Mapper> mapper(
      module, "SemanticMapper",
      "The whole pipeline: maps frames and refines the map with a CRF.");
  mapper
      .def(py::init<const Path&, const std::optional<std::vector<double>>&,
                    const py::kwargs&>(),
           py::arg("label_set"), py::arg("camera") = py::none(),
           "camera, for stereo pairs: fx, fy, cx, cy [px], baseline [m], width, "
           "height.\n"
           "Other keywords are parameters of pcl_semantic_map: crf='hierarchical'.")
      .def("process", &Mapper::process, py::arg("points"), py::arg("pose"),
           py::kw_only(), py::arg("probabilities") = py::none(),
           py::arg("colours") = py::none(),
           "Adds a cloud. Returns counts, and the voxels of the window after it.")
      .def("process_pair", &Mapper::processPair, py::arg("left"), py::arg("right"),
           py::arg("pose"), py::arg("probabilities"),
           "Adds a rectified stereo pair (H x W, or x 3 red green blue), the pose "
           "of\nthe left camera and H W x L probabilities of the left image's pixels.")
      .def("process_rgbd", &Mapper::processRgbd, py::arg("image"), py::arg("depths"),
           py::arg("pose"), py::kw_only(), py::arg("probabilities") = py::none(),
           "Adds an undistorted image (H x W, or x 3 red green blue) with its depths\n"
           "(H x W [m]; 0 or NaN = none), the pose of the camera and, if there are\n"
           "any, H x W x L probabilities of its pixels. The camera's baseline is\n"
           "ignored.")
      .def("finish", &Mapper::finish,
           "Refines the last frame, if the CRF has not seen it.");
  bindReading(mapper);
}

} // namespace pcl_semantic::python
