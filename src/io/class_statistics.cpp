// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/class_statistics.h>

#include "core/text_stream.h"
#include "files/report_text.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/map/voxel_set.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>

namespace pcl_semantic {

namespace {

// Turns counted sums into what is said of a class.
void
finish(ClassStatistics& entry, std::size_t voxels, std::size_t columns, double size)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  entry.fraction = voxels == 0 ? 0.0 : double(entry.voxels) / double(voxels);
  entry.volume = double(entry.voxels) * size * size * size;
  entry.area = double(columns) * size * size;
  if (entry.voxels == 0)
    entry.mean_z = entry.lowest_z = entry.highest_z = none;
  else
    entry.mean_z /= double(entry.voxels);
}

} // namespace

std::vector<ClassStatistics>
countClasses(const VoxelScene& scene, const LabelSet& label_set)
{
  std::vector<ClassStatistics> statistics(std::size_t(label_set.size()) + 1);
  std::vector<std::vector<VoxelIndex>> columns(statistics.size());
  for (std::size_t label = 0; label < statistics.size(); ++label)
    statistics[label].label = static_cast<Label>(label);
  for (std::size_t i = 0; i < scene.voxels.size(); ++i) {
    const auto label = static_cast<Label>((*scene.voxels.cloud)[i].label);
    static_cast<void>(label_set[label]); // throws if there is no such class
    const VoxelIndex& voxel = scene.voxels.indices[i];
    ClassStatistics& entry = statistics[label];
    const double z = centreOf(scene.grid, voxel).z() + scene.origin.z();
    entry.lowest_z = entry.voxels == 0 ? z : std::min(entry.lowest_z, z);
    entry.highest_z = entry.voxels == 0 ? z : std::max(entry.highest_z, z);
    entry.mean_z += z;
    ++entry.voxels;
    columns[label].emplace_back(voxel.x(), voxel.y(), 0);
  }
  for (std::size_t label = 0; label < statistics.size(); ++label)
    finish(statistics[label], scene.voxels.size(), VoxelSet(columns[label]).size(),
           scene.grid.size);
  return statistics;
}

void
writeClassStatistics(const std::string& path,
                     const std::vector<ClassStatistics>& statistics,
                     const LabelSet& label_set)
{
  TextStream text;
  text << std::setprecision(7); // what single precision has
  text << "label,class,voxels,fraction,volume_m3,area_m2,mean_z_m,lowest_z_m,"
          "highest_z_m\n";
  for (const ClassStatistics& entry : statistics) {
    text << int(entry.label) << "," << csvField(label_set[entry.label].name) << ","
         << entry.voxels;
    for (const double value : {entry.fraction, entry.volume, entry.area, entry.mean_z,
                               entry.lowest_z, entry.highest_z}) {
      text << ",";
      if (!std::isnan(value))
        text << value;
    }
    text << "\n";
  }
  writeTextFile(path, text.str());
}

} // namespace pcl_semantic
