// SPDX-License-Identifier: BSD-3-Clause

// Memory and time of SemanticCRF by the size of the cloud: a surface, random positions
// in a volume, and copies of a scan side by side; 11 classes and colour. Arguments: the
// sizes in millions of points (default: 0.1 1 5 20), then "tile=N" for another size of
// the tiles.

#include "bench/kitti_map.h"

#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace {

using namespace pcl_semantic;
using Point = pcl::PointXYZRGBL;
using Cloud = pcl::PointCloud<Point>;

constexpr int kClasses = 11;

// Squares of 4 m of one class; a third of the labels is wrong.
Point
pointAt(float x, float y, float z, std::mt19937& random)
{
  Point point;
  point.x = x;
  point.y = y;
  point.z = z;
  const unsigned square = unsigned(std::floor(x / 4.0f)) * 7u +
                          unsigned(std::floor(y / 4.0f)) * 13u +
                          unsigned(std::floor(z / 4.0f)) * 5u;
  const unsigned label = 1 + square % kClasses;
  point.label = random() % 3 == 0 ? 1 + random() % kClasses : label;
  point.r = std::uint8_t(label * 23 + random() % 20);
  point.g = std::uint8_t(label * 57 + random() % 20);
  point.b = std::uint8_t(label * 91 + random() % 20);
  return point;
}

Cloud::Ptr
surface(std::size_t points)
{
  std::mt19937 random(1);
  const auto side = std::size_t(std::sqrt(double(points)));
  const Cloud::Ptr cloud(new Cloud);
  cloud->reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const float x = float(i % side) * 0.05f, y = float(i / side) * 0.05f;
    cloud->push_back(pointAt(x, y, std::sin(x) + std::cos(y), random));
  }
  return cloud;
}

Cloud::Ptr
volume(std::size_t points)
{
  std::mt19937 random(2);
  const float edge = 0.06f * std::cbrt(float(points));
  const auto uniform = [&] { return float(random() >> 8) * 0x1p-24f * edge; };
  const Cloud::Ptr cloud(new Cloud);
  cloud->reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const float x = uniform(), y = uniform();
    cloud->push_back(pointAt(x, y, uniform(), random));
  }
  return cloud;
}

// Copies of a KITTI scan in squares of 120 m.
Cloud::Ptr
scans(std::size_t points)
{
  std::mt19937 random(3);
  const Cloud::Ptr cloud(new Cloud);
  const std::string data = realDataFolder();
  if (data.empty())
    return cloud;
  const auto scan = readVelodyneScan(data + "/kitti/05/velodyne/000000.bin");
  cloud->reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t copy = i / scan->size();
    const auto& point = (*scan)[i % scan->size()];
    cloud->push_back(pointAt(point.x + 120.0f * float(copy % 12),
                             point.y + 120.0f * float(copy / 12), point.z, random));
  }
  return cloud;
}

// A line "VmRSS: 1234 kB" of the process [bytes].
double
memoryOf(const char* name)
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(name, 0) == 0)
      return 1024.0 * std::atof(line.c_str() + std::strlen(name) + 1);
  return 0.0;
}

void
measure(const char* kind, Cloud::Ptr cloud, std::size_t tile)
{
  const auto points = double(cloud->size());
  if (cloud->empty())
    return void(std::printf("%s: skipped: PCL_SEMANTIC_DATA is not set\n", kind));
  SemanticCRF<Point> crf;
  crf.setLabelConfidence(0.8, kClasses);
  if (tile > 0)
    crf.setTileSize(tile);
  crf.setInputCloud(cloud);
  const double before = memoryOf("VmRSS");
  const auto start = std::chrono::steady_clock::now();
  crf.filter(*cloud);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  std::printf("%-8s %5.1f million points: %6.0f bytes and %5.2f us a point\n", kind,
              points / 1e6, (memoryOf("VmHWM") - before) / points,
              time.count() * 1e6 / points);
}

// In a process of its own, whose largest memory is that of this cloud.
void
measureApart(const char* kind, Cloud::Ptr (*make)(std::size_t), std::size_t points,
             std::size_t tile)
{
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    measure(kind, make(points), tile);
    std::fflush(stdout);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
}

} // namespace

int
main(int argc, char** argv)
{
  std::vector<double> millions;
  std::size_t tile = 0;
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "tile=", 5) == 0)
      tile = std::size_t(std::atof(argv[i] + 5));
    else
      millions.push_back(std::atof(argv[i]));
  if (millions.empty())
    millions = {0.1, 1.0, 5.0, 20.0};
  for (const double size : millions) {
    const auto points = std::size_t(size * 1e6);
    measureApart("surface", surface, points, tile);
    measureApart("volume", volume, points, tile);
    measureApart("scans", scans, points, tile);
  }
  return 0;
}
