// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/pipeline/tuning_runner.h>

#include <algorithm>
#include <set>

namespace pcl_semantic {

namespace {

// Gives the disparities of earlier runs, in the order of the frames.
class KnownDisparities : public DisparityEstimator {
public:
  explicit KnownDisparities(std::shared_ptr<const std::vector<DisparityImage>> images)
      : images_(std::move(images))
  {}

  DisparityImage
  estimate(const cv::Mat&, const cv::Mat&) override
  {
    const DisparityImage& image = images_->at(next_++);
    return {image.disparity.clone(), image.deviation}; // a mapper may thin it out
  }

private:
  std::shared_ptr<const std::vector<DisparityImage>> images_;
  std::size_t next_ = 0;
};

// Names of the parameters that play no part before the CRF.
std::set<std::string>
namesOfTheCrf()
{
  SemanticCRFParameters parameters;
  std::set<std::string> names = {"crf", "cliques", "clique_leaves_out",
                                 "clique_leaves_out_above", "threads"};
  for (const ConfigParameter& parameter : parametersOf(parameters, "m"))
    names.insert(parameter.name);
  CliqueParameters cliques;
  for (const ConfigParameter& parameter : parametersOf(cliques))
    names.insert(parameter.name);
  return names;
}

// Whether each frame's labels depend on nothing but its fused measurements.
bool
refinesEveryFrameAfresh(const MapperConfig& config)
{
  return config.crf_every == 1 && !config.crf_write_back;
}

} // namespace

TuningRunner::TuningRunner(std::vector<std::shared_ptr<const TuningSequence>> sequences,
                           const LabelSet& label_set, std::size_t memory)
    : sequences_(std::move(sequences)), label_set_(label_set), memory_(memory)
{
  // Once, before there are several threads: the runs ask for the same, each for itself.
  setNumberOfThreads(1);
}

std::string
TuningRunner::mapKey(const MapperConfig& config)
{
  static const std::set<std::string> of_the_crf = namesOfTheCrf();
  MapperConfig copy = config;
  std::string key;
  for (const ConfigParameter& parameter : parametersOf(copy))
    if (!of_the_crf.count(parameter.name))
      key += parameter.name + " " + parameter.text() + "\n";
  return key;
}

template <typename Visit>
void
TuningRunner::mapFrames(MapperConfig config, std::size_t sequence,
                        const Visit& visit) const
{
  config.threads = 1; // there are runs beside this one
  const TuningSequence& data = *sequences_.at(sequence);
  SemanticMapper mapper(data.camera(), label_set_, config,
                        data.makePredictor(config.label_confidence), data.makePoses());
  if (!data.calibration().empty())
    mapper.setLabelCalibration(readCalibration(data.calibration(), label_set_));
  mapper.setDisparityEstimator(
      std::make_unique<KnownDisparities>(data.disparities(config)));
  for (std::size_t i = 0; i < data.frames().size(); ++i) {
    MappedFrame mapped = mapper.process(data.frames()[i]);
    visit(makeTuningView(std::move(mapped), mapper.map(), data.camera(), data.truth(i),
                         config.map.max_range));
  }
}

TuningResult
TuningRunner::run(const MapperConfig& config, std::size_t sequence)
{
  TuningResult result(label_set_.size());
  if (!refinesEveryFrameAfresh(config)) {
    mapFrames(config, sequence,
              [&](const TuningView& view) { countView(view, result); });
    return result;
  }
  const std::shared_ptr<const Views> views = viewsOf(config, sequence);
  const TuningSequence& data = *sequences_.at(sequence);
  MapperConfig one_thread = config;
  one_thread.threads = 1;
  SemanticMapper mapper(data.camera(), label_set_, one_thread, nullptr, nullptr);
  for (const TuningView& view : *views) {
    TuningView copy = view;
    copy.mapped.voxels.cloud =
        std::make_shared<pcl::PointCloud<pcl::PointXYZRGBL>>(*view.mapped.voxels.cloud);
    mapper.refine(copy.mapped);
    countView(copy, result);
  }
  return result;
}

std::shared_ptr<TuningRunner::Entry>
TuningRunner::entryOf(const std::string& key)
{
  const std::lock_guard<std::mutex> lock(entries_lock_);
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const auto& entry) { return entry->key == key; });
  if (found == entries_.end()) {
    entries_.push_front(std::make_shared<Entry>());
    entries_.front()->key = key;
  }
  else
    entries_.splice(entries_.begin(), entries_, found);
  return entries_.front();
}

std::shared_ptr<const TuningRunner::Views>
TuningRunner::viewsOf(const MapperConfig& config, std::size_t sequence)
{
  const std::shared_ptr<Entry> entry =
      entryOf(mapKey(config) + std::to_string(sequence));
  const std::lock_guard<std::mutex> making(entry->making);
  if (entry->views)
    return entry->views;
  auto views = std::make_shared<Views>();
  MapperConfig without = config;
  without.crf = "none";
  std::size_t bytes = 0;
  mapFrames(without, sequence, [&](TuningView&& view) {
    view.mapped.voxels.refined = LabelDistributions(); // the measurements once more
    bytes += view.memory();
    views->push_back(std::move(view));
  });
  {
    const std::lock_guard<std::mutex> lock(entries_lock_);
    entry->bytes = bytes;
  }
  entry->views = views;
  forgetOldest();
  return views;
}

void
TuningRunner::forgetOldest()
{
  const std::lock_guard<std::mutex> lock(entries_lock_);
  std::size_t used = 0;
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    used += (*entry)->bytes;
    const bool is_kept = used <= memory_ || (*entry)->bytes == 0; // 0: being made
    if (!is_kept)
      used -= (*entry)->bytes;
    entry = is_kept ? std::next(entry) : entries_.erase(entry);
  }
}

} // namespace pcl_semantic
