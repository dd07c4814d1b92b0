// SPDX-License-Identifier: BSD-3-Clause
#include "other_formats.h"

#include "core/fail.h"

#include <boost/algorithm/string/case_conv.hpp>

#include <filesystem>
#include <fstream>
#include <string_view>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

struct Format {
  std::string_view extension, first_bytes; // empty: any
  const char *name, *conversion;           // %: the file's name without its extension
};

constexpr const char* by_pdal = "pdal translate % %.ply";
constexpr const char* by_numpy = "pcl_semantic.write_cloud() in Python";
constexpr const char* by_mesh = "pcl_mesh2pcd % %.pcd, or CloudCompare";
constexpr const char* by_archive = "pcl_semantic_archive export % %.pcd";
constexpr const char* by_ros = "ros2 run pcl_ros bag_to_pcd";

constexpr Format formats[] = {
    {".las", "LASF", "LAS", by_pdal},
    {".laz", "LASF", "LAZ", by_pdal},
    {".e57", "ASTM-E57", "E57", by_pdal},
    {".xyz", "", "text", by_pdal},
    {".txt", "", "text", by_pdal},
    {".asc", "", "text", by_pdal},
    {".csv", "", "text", by_pdal},
    {".pts", "", "text", by_pdal},
    {".ptx", "", "text", by_pdal},
    {".npy", "\x93NUMPY", "NumPy's", by_numpy},
    {".npz", "", "NumPy's", by_numpy},
    {".obj", "", "a mesh", by_mesh},
    {".stl", "", "a mesh", by_mesh},
    {".bag", "#ROSBAG", "a bag of ROS", by_ros},
    {".db3", "", "a bag of ROS", by_ros},
    {".map", "SQLite format 3", "a map archive", by_archive},
    {".mcap", "\x89MCAP", "a bag of ROS", by_ros},
    {".pcap", "", "packets of a scanner", "the driver of the scanner"},
};

bool
begins(std::string_view text, std::string_view with)
{
  return text.substr(0, with.size()) == with;
}

std::string
firstBytes(const std::string& path)
{
  std::string bytes(64, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(std::size_t(file.gcount()));
  return bytes;
}

// The conversion command with the file names filled in.
std::string
commandOf(const Format& format, const fs::path& path)
{
  std::string command;
  bool is_input = true;
  for (const char* c = format.conversion; *c; ++c)
    if (*c != '%')
      command += *c;
    else {
      command += is_input ? path.string() : fs::path(path).replace_extension().string();
      is_input = false;
    }
  return command;
}

} // namespace

void
refuseOtherFormats(const std::string& path)
{
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return;
  const std::string extension =
      boost::algorithm::to_lower_copy(fs::path(path).extension().string());
  const std::string bytes = firstBytes(path);
  if (begins(bytes, "version https://git-lfs.github.com/spec/"))
    badInput(path, ": is a Git LFS pointer, expected .pcd, .ply or .bin; git lfs pull "
                   "fetches the file");
  if (begins(bytes, "# .PCD") || begins(bytes, "VERSION"))
    return; // regardless of its name
  const auto refuse = [&](const Format& format) {
    badInput(path, ": is ", format.name,
             ", expected .pcd, .ply or .bin; convert it: ", commandOf(format, path));
  };
  for (const Format& format : formats)
    if (extension == format.extension)
      refuse(format);
  for (const Format& format : formats)
    if (!format.first_bytes.empty() && begins(bytes, format.first_bytes))
      refuse(format);
}

} // namespace pcl_semantic
