// SPDX-License-Identifier: BSD-3-Clause
#include "pcd_reader.h"

#include "clouds/table_parts.h"
#include "core/fail.h"
#include "pcd_data.h"
#include "pcd_header.h"

#include <pcl_semantic/files/input_file.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

// A header has a few hundred bytes, or some thousand with a field per class.
constexpr std::size_t kMaxHeader = 1 << 20;

std::vector<std::uint8_t>
bytesOf(const std::string& path, std::ifstream& stream, std::size_t offset,
        std::size_t size)
{
  std::vector<std::uint8_t> bytes(size);
  stream.clear();
  stream.seekg(std::streamoff(offset));
  stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
  if (std::size_t(stream.gcount()) != size)
    badInput(path, ": cannot be read beyond byte ",
             offset + std::size_t(stream.gcount()));
  return bytes;
}

PcdHeader
headerOf(const std::string& path)
{
  requireRegularFile(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    badInput(path, ": cannot be opened");
  const auto begin =
      bytesOf(path, stream, 0, std::min<std::size_t>(kMaxHeader, fs::file_size(path)));
  return parsePcdHeader(path, textOf(begin));
}

} // namespace

bool
PcdReader::canRead(const std::string& path)
{
  return boost::algorithm::to_lower_copy(fs::path(path).extension().string()) ==
             ".pcd" &&
         headerOf(path).encoding == PcdEncoding::binary;
}

PcdReader::PcdReader(const std::string& path) : path_(path)
{
  PcdHeader header = headerOf(path);
  if (header.encoding != PcdEncoding::binary)
    badInput(path, ": its points are not binary, so they cannot be read in parts");
  header_ = std::move(header.table);
  data_offset_ = header.data_offset;
  stream_.open(path, std::ios::binary);
  const std::size_t available = fs::file_size(path) - data_offset_;
  const std::size_t end = binarySize(path, header_, available);
  const auto rest = bytesOf(path, stream_, data_offset_ + end,
                            std::min(available - end, kMaxBehindData));
  checkBehindData(path, available - end, textOf(rest));
  header_.removeColumns(kPadding);
}

PcdTable
PcdReader::read(std::size_t first, std::size_t count)
{
  if (first > size() || count > size() - first)
    badParameter(path_, ": points ", first, " to ", first + count, " of ", size());
  PcdTable table = header_;
  table.width = pcl::uindex_t(count);
  table.height = 1;
  table.row_step = table.width * table.point_step;
  table.data = bytesOf(path_, stream_, data_offset_ + first * table.point_step,
                       count * table.point_step);
  return table;
}

} // namespace pcl_semantic
