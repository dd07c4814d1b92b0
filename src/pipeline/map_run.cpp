// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_run.h>

#include "core/fail.h"
#include "core/split.h"
#include "core/text_stream.h"
#include "fitted_window.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/map/map_doubts.h>
#include <pcl_semantic/pipeline/frame_digest.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <utility>

namespace pcl_semantic {

namespace {

// The words of `also` in a form that is not taken for a path.
std::string
wordsIn(const std::string& also)
{
  std::vector<std::string> words;
  for (const std::string_view word : splitAt(',', also))
    words.emplace_back(word);
  std::sort(words.begin(), words.end());
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "[" : ", ") + word;
  return text.empty() ? text : text + "]";
}

// The content of an existing archive.
struct MadeMap {
  std::vector<FrameRecord> frames;
  bool is_finished = false;
  std::string fault; // reason why it is of another run, or unreadable
};

MadeMap
readMadeMap(const std::string& path, const MappingRun& run)
{
  MadeMap made;
  try {
    const MapArchive archive(path, ArchiveAccess::read);
    made.fault = changeOfRun(archive.header().configuration, describeRun(run));
    archive.forEachFrame([&](int number, const std::vector<std::uint8_t>& bytes) {
      made.frames.push_back(decodeFrameRecord(number, bytes));
    });
    made.is_finished =
        archive.state().finished && made.frames.size() == run.frames.size();
    const std::vector<std::string> faults = verifyArchive(path);
    if (made.fault.empty() && !faults.empty())
      made.fault = faults.front();
  }
  catch (const BadInputException& error) {
    made.fault = error.what();
  }
  return made;
}

} // namespace

MapRun::MapRun(OpenedInputs inputs, const MapperConfig& config, MapOutputs outputs,
               MapRunObserver* observer)
    : observer_(observer ? *observer : no_observer_), inputs_(std::move(inputs)),
      outputs_(std::move(outputs))
{
  run_.inputs = inputs_.values;
  run_.inputs.emplace_back("also", wordsIn(outputs_.also));
  for (const FrameTime& frame : inputs_.source->frames())
    run_.frames.push_back(frame.number);
  run_.camera = inputs_.source->sensor().camera;
  run_.T_camera0_camera = inputs_.source->sensor().T_camera0_sensor;
  run_.label_set = inputs_.label_set;
  run_.config = config;
  run_.config.validate();
  run_.finds_planes = run_.config.things; // also of classes that have no objects
  run_.config.things = run_.config.things && run_.label_set.hasThings();
  if (!inputs_.has_labels)
    run_.config.crf = CRFModelType::unary;
  if (auto& sensor = run_.config.crf_parameters.sensor;
      sensor == PointSensor::automatic && run_.camera) // a merge has no other trace
    sensor =
        inputs_.source->sensor().has_depth ? PointSensor::rgbd : PointSensor::stereo;
  if (!isLive() && !outputs_.archive.path.empty() && inputs_.has_odometry)
    badParameter(
        "--archive needs poses from a file: odometry cannot resume a killed run; write "
        "poses with pcl_semantic_odometry and give them with --poses");
  requireLabels();
  setExtras();
  inputs_.poses->requirePoses(inputs_.source->frames());
  fitWindow();
  for (const std::string& text : doubtsOf(run_.config.map))
    doubt(text);
  for (const std::string& text : inputs_.doubts)
    doubt(text);
}

MapRun::~MapRun() = default;

// Sizes the window by the depths of a recording.
void
MapRun::fitWindow()
{
  MapParameters& map = run_.config.map;
  if (isLive() || !inputs_.source->sensor().has_depth || !map.window.isZero(0.0))
    return;
  if (const std::optional<double> reach = reachOfDepths(*inputs_.source)) {
    map.window = windowOfReach(*reach, map.max_range);
    fitted_reach_ = std::min(*reach, map.max_range) + 2.0;
  }
}

// Warns of a frame with many points outside a window that was fitted to others.
void
MapRun::doubtWindow(const MappedFrame& mapped)
{
  if (!fitted_reach_)
    return;
  std::size_t measured = 0, outside = 0;
  for (const pcl::PointXYZRGB& point : *mapped.cloud) {
    const bool is_mapped = double(point.z) <= run_.config.map.max_range; // false: NaN
    measured += is_mapped;
    outside += is_mapped && double(point.getVector3fMap().norm()) > *fitted_reach_;
  }
  if (20 * outside <= measured)
    return;
  TextStream text;
  text << "frame " << mapped.frame.number << ": "
       << std::round(100.0 * double(outside) / double(measured))
       << " % of its depths lie outside the window, which fits other frames; give "
          "--window or --max-depth";
  doubt(text.str());
  fitted_reach_.reset(); // once
}

bool
MapRun::isLive() const
{
  return run_.frames.empty();
}

void
MapRun::doubt(const std::string& text)
{
  observer_.onDoubt(text);
}

void
MapRun::doubtMapping()
{
  if (!inputs_.mapping)
    return;
  const std::string lacking =
      textOfLacking(*inputs_.mapping, inputs_.mapping_name, inputs_.mapping_unit);
  if (!lacking.empty())
    doubt(lacking);
}

// Warns of jumps: poses of other frames, or not in metres.
void
MapRun::doubtDistance(const MappedFrame& mapped)
{
  const Eigen::Vector3d position = mapped.T_world_camera.translation();
  const double distance = last_position_ ? (position - *last_position_).norm() : 0.0;
  last_position_ = position;
  if (has_doubted_distance_ || !(distance > run_.config.map.max_range))
    return;
  has_doubted_distance_ = true;
  TextStream text;
  text << "frame " << mapped.frame.number << " is " << std::round(distance)
       << " m from the one before it: are the poses in metres, and of these frames?";
  doubt(text.str());
}

void
MapRun::doubtTracking()
{
  const int lost = poses_->lostFrames();
  const int frames = isLive() ? int(frames_mapped_) : int(run_.frames.size());
  if (lost == 0)
    return;
  if (lost + 1 == frames)
    badInput(inputs_.name, ": no frame could be tracked");
  doubt(std::to_string(lost) +
        " frames could not be tracked: their poses are predicted");
}

// Checks the frames whose labels are used (network_every).
void
MapRun::requireLabels() const
{
  std::vector<int> labelled;
  for (std::size_t i = 0; i < run_.frames.size();
       i += std::size_t(run_.config.network_every))
    labelled.push_back(run_.frames[i]);
  if (inputs_.predictor)
    inputs_.predictor->requireFrames(labelled);
}

void
MapRun::setExtras()
{
  if (!(outputs_.scan_within >= 0.0 && outputs_.scan_within <= 2.0))
    badParameter("--scan-within is ", outputs_.scan_within, ", expected 0 to 2");
  extras_.images = outputs_.images;
  extras_.centres = outputs_.centres;
  extras_.within = outputs_.scan_within;
  for (const std::string_view word : splitAt(',', outputs_.also))
    if (word == "measured")
      extras_.measured = true;
    else if (word == "depth")
      extras_.depth = true;
    else if (word == "probabilities")
      extras_.probabilities = true;
    else if (word == "scans" && inputs_.scans)
      extras_.scan = inputs_.scans();
    else if (word == "scans")
      badParameter("--also scans needs a SEQUENCE with laser scans (velodyne), or "
                   "--clouds");
    else
      badParameter("--also: '", word,
                   "', expected measured, depth, probabilities or scans");
  const bool needs_images = extras_.measured || extras_.depth || extras_.probabilities;
  if (!extras_.images && needs_images)
    badParameter("--also measured, depth and probabilities need the images that "
                 "--map-only leaves out");
  if (!run_.camera && (extras_.depth || extras_.probabilities))
    badParameter("--also depth and probabilities are for frames of a camera");
  if (!run_.camera && extras_.measured && !extras_.scan)
    badParameter("--also measured of clouds without a camera also needs scans");
}

// Difference between a mapped frame and the same frame now. For a network, its files
// are compared, not its labels.
std::string
MapRun::changeOf(std::size_t i, const FrameRecord& mapped)
{
  inputs_.source->seek(i);
  const SensorFrame frame = *inputs_.source->next();
  const bool is_labelled = i % std::size_t(run_.config.network_every) == 0;
  LabelDistributions labels;
  if (const auto* const cloud = std::get_if<CloudFrame>(&frame)) {
    if (is_labelled)
      labels = cloud->distributions;
  }
  else if (is_labelled && inputs_.labels_are_stored) {
    const auto* const pair = std::get_if<StereoFrame>(&frame);
    labels = inputs_.predictor->predict(
        pair ? pair->left : std::get<RgbdFrame>(frame).image, mapped.number);
  }
  const FrameDigest now = digestOf(frame, labels);
  const auto differ = [](std::uint64_t a, std::uint64_t b) {
    return a != 0 && b != 0 && a != b;
  };
  const std::string name = "frame " + std::to_string(mapped.number);
  if (differ(mapped.digest.data, now.data))
    return name;
  if (differ(mapped.digest.labels, now.labels))
    return "labels of " + name;
  // NaN: unknown
  const double time = inputs_.source->frames()[i].timestamp;
  return mapped.timestamp < time || mapped.timestamp > time ? "time of " + name : "";
}

// First difference between the mapped frames and the same frames now.
std::string
MapRun::changeSince(const std::vector<FrameRecord>& mapped)
{
  std::string change;
  for (std::size_t i = 0; i < mapped.size() && change.empty(); ++i)
    change = i < run_.frames.size() && mapped[i].number == run_.frames[i]
                 ? changeOf(i, mapped[i])
                 : "frame " + std::to_string(mapped[i].number);
  inputs_.source->seek(0);
  return change;
}

bool
MapRun::isMade()
{
  const std::string& path = outputs_.archive.path;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    removeArchive(path); // removes a log without archive
    return false;
  }
  MadeMap made = readMadeMap(path, run_);
  if (made.fault.empty())
    made.fault = changeSince(made.frames);
  if (made.fault.empty())
    return made.is_finished;
  observer_.onNote(path + ": is mapped again: " + made.fault);
  removeArchive(path);
  return false;
}

void
MapRun::makeMapper(std::shared_ptr<BlockStore> store)
{
  poses_ = inputs_.poses.get();
  std::unique_ptr<LabelPredictor> late;
  if (labels_late_)
    late = std::exchange(inputs_.predictor, std::make_unique<NoLabels>());
  mapper_ = std::make_unique<SemanticMapper>(
      run_.label_set, run_.config, std::move(inputs_.poses), run_.camera,
      std::move(inputs_.predictor), std::move(store));
  if (inputs_.label_calibration)
    mapper_->setLabelCalibration(*inputs_.label_calibration);
  if (late)
    late_labels_.emplace(std::move(late), *mapper_);
}

void
MapRun::mapFrames(MappingArchive& archive, MappingOutput* output)
{
  observer_.onBegin(isLive() ? 0 : run_.frames.size() - frames_before_);
  while (!observer_.isInterrupted()) {
    const std::optional<SensorFrame> frame = inputs_.source->next();
    if (!frame)
      break;
    observer_.onFrame(*frame);
    if (late_labels_)
      late_labels_->fuseReady();
    MappedFrame mapped = mapper_->process(*frame);
    if (late_labels_)
      late_labels_->offer(mapped);
    mapped.times.measure("output", [&] {
      if (output)
        output->writeFrame(mapped, mapper_->map());
      archive.add(*frame, mapped, *mapper_);
      if (output && observer_.isWatched())
        output->writeLive(mapped);
    });
    ++frames_mapped_;
    is_empty_ = is_empty_ && mapped.voxels.size() == 0;
    has_points_ = has_points_ || mapped.counts.invalid < mapped.counts.points;
    doubtDistance(mapped);
    doubtWindow(mapped);
    observer_.onMapped(*frame, mapped);
  }
  if (late_labels_)
    late_labels_->fuseLast();
}

void
MapRun::run()
{
  MappingArchive archive(outputs_.archive, run_);
  const std::vector<FrameRecord>& records = archive.records();
  frames_before_ = records.size();
  is_empty_ = records.empty();
  const std::string change = changeSince(records);
  if (!change.empty())
    badInput(outputs_.archive.path, ": ", change,
             " changed since the archived run; restore the old data, or use another "
             "archive");
  inputs_.source->seek(frames_before_);
  makeMapper(archive.store());
  std::optional<MappingOutput> output;
  if (!outputs_.folder.empty()) {
    MappingRun described = run_;
    for (const auto& input : outputs_.summary)
      described.inputs.push_back(input);
    output.emplace(outputs_.folder, described, records, extras_);
  }
  archive.resume(*mapper_);
  std::exception_ptr error;
  try {
    mapFrames(archive, output ? &*output : nullptr);
  }
  catch (...) {
    if (!isLive() || frames_mapped_ == 0)
      throw;
    error = std::current_exception();
  }
  if (is_empty_ && !error)
    doubt(has_points_ ? "the map is empty: no point lies within --max-depth of the "
                        "sensor (coordinates are metres, in the sensor's frame)"
                      : "the map is empty: no frame has a point with a valid depth");
  if (!isLive())
    doubtTracking();
  if (error)
    archive.abandon(*mapper_);
  else
    archive.finish(*mapper_);
  finish(archive, output ? &*output : nullptr, !error);
  if (error)
    std::rethrow_exception(error);
  if (isLive())
    doubtTracking();
}

void
MapRun::finish(MappingArchive& archive, MappingOutput* output, bool is_whole)
{
  const std::size_t frames = frames_before_ + frames_mapped_;
  if (output)
    output->finish(mapper_->map(), mapper_->objects(),
                   is_whole && (isLive() || frames == run_.frames.size()));
  constexpr double usual_shift = 1.0;
  if (output && output->domainShift() > usual_shift) {
    TextStream text;
    for (const auto& [input, value] : run_.inputs)
      if (input == "label_calibration")
        text << value;
    text << ": was learned from data unlike this sequence (domain shift "
         << output->domainShift()
         << ", expected at most 1): compare the map with one without it";
    doubt(text.str());
  }
  if (!archive.close())
    doubt(outputs_.archive.path + ": is being read by another program: " +
          outputs_.archive.path + "-wal is kept until then");
  doubtMapping();
}

void
removeArchive(const std::string& path)
{
  for (const char* const ending : {"", "-wal", "-shm", "-journal"}) {
    std::error_code error;
    std::filesystem::remove(path + ending, error);
    if (error)
      fail<OutputException>(path + ending, ": cannot be removed: ", error.message());
  }
}

} // namespace pcl_semantic
