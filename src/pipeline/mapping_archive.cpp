// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/mapping_archive.h>

#include "core/fail.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/pipeline/frame_digest.h>
#include <pcl_semantic/superpixels/clique_config.h>

#include <filesystem>
#include <optional>
#include <utility>

namespace pcl_semantic {

namespace {

void
requireSameRun(const MapArchive& archive, const MappingRun& run)
{
  const std::string change =
      changeOfRun(archive.header().configuration, describeRun(run));
  if (!change.empty())
    badInput(archive.path(), ": is the archive of another run: ", change);
}

} // namespace

MappingArchive::MappingArchive(const Options& options, const MappingRun& run)
    : options_(options)
{
  if (!options_.path.empty() && namesCliques(run.config.cliques, "superpixel") &&
      run.config.clique_parameters.superpixel.keep)
    badParameter("--archive and superpixel_keep exclude each other: an archive does "
                 "not store superpixels");
  if (!run.frames.empty())
    last_frame_ = run.frames.back();
  if (options_.path.empty())
    return;
  std::error_code error;
  const bool is_there = std::filesystem::exists(options_.path, error);
  if (is_there && !options_.resume)
    fail<OutputException>(
        options_.path, ": is there already; continue it with --resume, or remove it");
  if (is_there) {
    // Before the archive is opened for writing.
    requireSameRun(MapArchive(options_.path, ArchiveAccess::read), run);
    archive_ = std::make_shared<MapArchive>(options_.path, ArchiveAccess::write);
    archive_->forEachFrame([&](int number, const std::vector<std::uint8_t>& bytes) {
      records_.push_back(decodeFrameRecord(number, bytes));
    });
  }
  else {
    makeOutputFolder(std::filesystem::absolute(options_.path).parent_path().string());
    archive_ = MapArchive::create(
        options_.path, {run.label_set, run.config.map.withWindow(), describeRun(run)});
  }
  is_new_ = !is_there;
}

MappingArchive::~MappingArchive()
{
  if (!is_new_ || archive_->state().frames > 0)
    return;
  try {
    close();
  }
  catch (const std::exception&) { // already reported
  }
  archive_.reset();
  try {
    std::error_code ignored;
    for (const char* const ending : {"", "-wal", "-shm"})
      std::filesystem::remove(options_.path + ending, ignored);
  }
  catch (const std::bad_alloc&) { // the files stay
  }
}

std::shared_ptr<BlockStore>
MappingArchive::store() const
{
  return archive_;
}

void
MappingArchive::resume(SemanticMapper& mapper) const
{
  if (records_.empty())
    return;
  const ArchiveState state = archive_->state();
  std::optional<MapObjects> objects = archive_->objects();
  if (mapper.objects() && !objects)
    badInput(options_.path, ": is damaged: has no 'objects'");
  mapper.resume(static_cast<int>(records_.size()), state.finished, state.cloud_origin,
                std::move(objects));
}

void
MappingArchive::add(const SensorFrame& frame, const MappedFrame& mapped,
                    SemanticMapper& mapper)
{
  if (!archive_)
    return;
  FrameRecord record = recordOf(mapped);
  record.digest = digestOf(frame, mapped.network);
  archive_->putFrame(mapped.frame.number, encodeFrameRecord(record));
  added_frame_ = mapped.frame.number;
  // finish() commits the last frame together with its CRF result. Until then, a resumed
  // run needs a frame to continue with.
  if (++since_commit_ >= options_.every && added_frame_ != last_frame_)
    commit(mapper, false);
}

void
MappingArchive::finish(SemanticMapper& mapper)
{
  const bool is_live = last_frame_ < 0;
  const bool finished = is_live ? added_frame_ >= 0 : added_frame_ == last_frame_;
  // An uninterrupted run would not call mapper.finish() here, so commit before it.
  if (archive_ && !finished && since_commit_ > 0)
    commit(mapper, false);
  mapper.finish();
  if (archive_ && finished)
    commit(mapper, true);
}

void
MappingArchive::abandon(SemanticMapper& mapper)
{
  mapper.finish();
  if (archive_)
    commit(mapper, false);
}

void
MappingArchive::commit(SemanticMapper& mapper, bool finished)
{
  mapper.flush();
  ArchiveState state;
  state.cloud_origin = mapper.map().cloudOrigin();
  state.finished = finished;
  if (const std::optional<MapObjects> changes = mapper.takeObjectChanges())
    archive_->putObjects(*changes);
  archive_->commit(state);
  since_commit_ = 0;
}

bool
MappingArchive::close()
{
  return !archive_ || archive_->close();
}

} // namespace pcl_semantic
