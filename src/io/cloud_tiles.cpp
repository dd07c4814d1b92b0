// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace pcl_semantic {

namespace {

// A stored row: the number of the point times two, plus one around a tile; the point.
constexpr std::size_t kNumberSize = sizeof(std::uint64_t);

TileLimits
limitsOf(const TileOptions& options, const CloudSample& sample)
{
  const double share =
      double(sample.positions.cols()) / double(std::max<std::size_t>(sample.points, 1));
  TileLimits limits;
  limits.reach = options.reach;
  limits.most = std::max<std::size_t>(std::size_t(double(options.most) * share), 1);
  limits.is_most_with_halo = true;
  limits.worthwhile = 0.95; // memory is more important than time
  return limits;
}

// Points at 0 0 0 are no returns only if there are two or more of them, so a box has
// none of them, or many.
std::size_t
boxOfNoReturn(std::size_t number, std::size_t all, std::size_t boxes)
{
  constexpr std::size_t together = 1000;
  const std::size_t groups = std::max<std::size_t>(all / together, 1);
  return std::min(number / together, groups - 1) % boxes;
}

// The same position for all points of a voxel.
Eigen::Vector3f
centreOfVoxel(const Eigen::Vector3d& absolute, const Eigen::Vector3d& origin,
              double size)
{
  const Eigen::Array3d voxel = (absolute.array() / size).floor();
  return ((voxel + 0.5) * size - origin.array()).cast<float>();
}

} // namespace

CloudTiles::CloudTiles(PcdReader& reader, const CloudSurvey& survey,
                       const TileOptions& options, const std::string& folder,
                       const std::function<void()>& step)
    : header_(reader.header()),
      boxes_(survey.sample.positions, limitsOf(options, survey.sample)),
      store_(folder, kNumberSize + header_.point_step, boxes_.size())
{
  std::vector<std::uint8_t> row(store_.rowSize());
  std::size_t last = 0; // points without a position stay with those before
  std::size_t no_returns = 0;
  forEachBlock(reader, [&](std::size_t first, const PcdTable& table) {
    const PointPlaces places = survey.placesOf(table);
    const PcdColumn x(table, table.find("x")), y(table, table.find("y")),
        z(table, table.find("z"));
    for (std::size_t i = 0; i < table.points(); ++i) {
      const auto put = [&](std::size_t box, bool is_around) {
        const std::uint64_t number = (first + i) * 2 + (is_around ? 1 : 0);
        std::memcpy(row.data(), &number, kNumberSize);
        std::copy_n(table.data.data() + i * table.point_step, table.point_step,
                    row.data() + kNumberSize);
        store_.append(box, row.data());
        around_ += is_around ? 1 : 0;
      };
      Eigen::Vector3f position = places.positions.col(Eigen::Index(i));
      if (!position.allFinite()) {
        put(places.no_returns[i]
                ? boxOfNoReturn(no_returns++, survey.no_returns, boxes_.size())
                : last,
            false);
        continue;
      }
      if (options.voxel_size > 0.0)
        position =
            centreOfVoxel({x(i), y(i), z(i)}, survey.sample.origin, options.voxel_size);
      last = boxes_.boxOf(position);
      put(last, false);
      if (options.reach > 0.0)
        boxes_.forEachNear(position, [&](std::size_t box) {
          if (box != last)
            put(box, true);
        });
    }
    points_ += table.points();
    step();
  });
}

CloudTile
CloudTiles::read(std::size_t tile) const
{
  const std::vector<std::uint8_t> rows = store_.read(tile);
  const std::size_t count = rows.size() / store_.rowSize();
  CloudTile result;
  result.table = header_;
  result.table.width = pcl::uindex_t(count);
  result.table.height = 1;
  result.table.row_step = result.table.width * result.table.point_step;
  result.table.data.reserve(count * header_.point_step);
  for (const std::uint64_t around : {0, 1})
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint8_t* const row = rows.data() + k * store_.rowSize();
      std::uint64_t number = 0;
      std::memcpy(&number, row, kNumberSize);
      if (number % 2 != around)
        continue;
      if (around == 0)
        result.numbers.push_back(number / 2);
      result.table.data.insert(result.table.data.end(), row + kNumberSize,
                               row + store_.rowSize());
    }
  return result;
}

} // namespace pcl_semantic
