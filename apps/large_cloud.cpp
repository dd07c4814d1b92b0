// SPDX-License-Identifier: BSD-3-Clause
#include "large_cloud.h"
#include "cloud_doubts.h"
#include "messages.h"

#include "core/fail.h"
#include "core/text_stream.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

namespace fs = std::filesystem;

constexpr double kGigabyte = 1e9;
constexpr double kLeastMemory = 0.3 * kGigabyte;
constexpr double kMillion = 1e6;

// The programs and their libraries, and the rows that are not on disk yet.
constexpr double kOverhead = 0.22 * kGigabyte;

double
memoryOfMachine()
{
  double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  std::ifstream group("/sys/fs/cgroup/memory.max"); // "max" without a limit
  double limit = 0.0;
  if (group >> limit && limit > 0.0)
    memory = std::min(memory, limit);
  return memory;
}

double
bytesOf(double points, const CloudNeeds& needs, double point_step)
{
  // The table of the file, and the one with the new fields.
  return kOverhead + needs.fixed * std::min(1.0, points / kMillion) +
         points * (needs.per_point + 3.0 * point_step);
}

std::size_t
blocksOf(const PcdReader& reader)
{
  return (reader.size() + kBlockOfPoints - 1) / kBlockOfPoints;
}

} // namespace

std::size_t
memoryOf(double gigabytes)
{
  if (gigabytes == 0.0)
    return std::size_t(memoryOfMachine() / 2.0);
  if (!(gigabytes * kGigabyte >= kLeastMemory) || !std::isfinite(gigabytes))
    fail<InvalidParameterException>(
        "--memory is ", gigabytes, " GB, expected at least ", kLeastMemory / kGigabyte);
  return std::size_t(gigabytes * kGigabyte);
}

bool
needsTiles(const std::string& path, const CloudNeeds& needs, std::size_t memory)
{
  std::error_code error;
  const auto file_size = double(fs::file_size(path, error));
  if (error || file_size < 1e6)
    return false; // small, or reported by its reader
  const bool is_divisible = PcdReader::canRead(path);
  double points = file_size / 20.0, step = 20.0; // about, of other formats
  if (is_divisible) {
    const PcdReader reader(path);
    points = double(reader.size());
    step = double(reader.header().point_step);
  }
  const double bytes = bytesOf(points, needs, step);
  if (bytes <= double(memory))
    return false;
  if (is_divisible)
    return true;
  TextStream text;
  text << path << ": may need " << std::ceil(bytes / kGigabyte * 10.0) / 10.0
       << " GB of memory, more than " << double(memory) / kGigabyte
       << "; only a binary .pcd can be read in tiles";
  warn(text.str());
  return false;
}

std::size_t
pointsOfTile(const CloudNeeds& needs, std::size_t point_step, std::size_t memory)
{
  constexpr double least = 20000.0;
  const double per_point =
      needs.fixed / kMillion + needs.per_point + 3.0 * double(point_step);
  return std::size_t(
      std::clamp((double(memory) - kOverhead) / per_point, least, kMillion));
}

CloudSurvey
surveyWithProgress(PcdReader& reader, const LabelMapping* mapping,
                   bool measures_spacing)
{
  ProgressBar progress("reading", (measures_spacing ? 3 : 2) * blocksOf(reader),
                       "blocks");
  const auto step = [&] { progress.step(); };
  CloudSurvey survey = surveyCloud(reader, mapping, step);
  if (measures_spacing)
    measureSpacing(reader, step, survey);
  warnOf(survey.doubts);
  warnOfNoReturns(reader.path(), survey.no_returns);
  return survey;
}

std::unique_ptr<CloudTiles>
divideWithProgress(PcdReader& reader, const CloudSurvey& survey,
                   const TileOptions& options, const std::string& output)
{
  ProgressBar progress("dividing", blocksOf(reader), "blocks");
  auto tiles = std::make_unique<CloudTiles>(reader, survey, options,
                                            fs::path(output).parent_path().string(),
                                            [&] { progress.step(); });
  if (tiles->shareAround() > 2.0) {
    TextStream text;
    text << "the tiles need " << std::round(10.0 * tiles->shareAround()) / 10.0
         << " points around them for each of theirs; a larger --memory is faster";
    warn(text.str());
  }
  return tiles;
}

void
forEachTileOf(const CloudTiles& tiles, const std::string& what,
              const std::function<void(CloudTile)>& use)
{
  ProgressBar progress(what, tiles.size(), "tiles");
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    CloudTile tile = tiles.read(i);
    if (!tile.numbers.empty())
      use(std::move(tile));
    progress.step();
  }
}

} // namespace pcl_semantic::tool
