// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_row_writer.h"

#include "core/fail.h"
#include "files/pcd_header.h"

#include <pcl_semantic/files/atomic_file.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr std::size_t kNumberSize = sizeof(std::uint64_t);
constexpr std::size_t kBucketSize = std::size_t(1) << 20; // [points]

bool
isSame(const pcl::PCLPointField& a, const pcl::PCLPointField& b)
{
  return a.name == b.name && a.datatype == b.datatype && a.count == b.count;
}

} // namespace

CloudRowWriter::CloudRowWriter(std::string path, std::size_t most)
    : path_(std::move(path)), most_(most)
{}

void
CloudRowWriter::append(const PcdTable& table, const std::vector<std::uint64_t>& numbers)
{
  if (!store_) {
    fields_ = table.fields;
    for (const pcl::PCLPointField& field : fields_)
      row_size_ += sizeOfField(field);
    store_ =
        std::make_unique<RowStore>(std::filesystem::path(path_).parent_path().string(),
                                   kNumberSize + row_size_, most_ / kBucketSize + 1);
  }
  if (!std::equal(fields_.begin(), fields_.end(), table.fields.begin(),
                  table.fields.end(), isSame))
    badInput(path_, ": parts of the cloud have different fields");
  std::vector<std::uint8_t> row(store_->rowSize());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::memcpy(row.data(), &numbers[i], kNumberSize);
    const std::uint8_t* const point = table.data.data() + i * table.point_step;
    std::uint8_t* to = row.data() + kNumberSize;
    for (const pcl::PCLPointField& field : table.fields)
      to = std::copy_n(point + field.offset, sizeOfField(field), to);
    store_->append(numbers[i] / kBucketSize, row.data());
  }
}

void
CloudRowWriter::write(const PcdTable& header)
{
  PcdTable written = header;
  written.fields = fields_;
  AtomicFile file(path_);
  writePcdHeader(file.stream(), written);
  const std::size_t points = header.points();
  for (std::size_t first = 0; first < points; first += kBucketSize) {
    const std::size_t count = std::min(kBucketSize, points - first);
    const std::vector<std::uint8_t> rows = store_->read(first / kBucketSize);
    if (rows.size() != count * store_->rowSize())
      badParameter(path_, ": ", rows.size() / store_->rowSize(), " points from ", first,
                   " on, expected ", count);
    std::vector<char> sorted(count * row_size_);
    for (std::size_t at = 0; at < rows.size(); at += store_->rowSize()) {
      std::uint64_t number = 0;
      std::memcpy(&number, rows.data() + at, kNumberSize);
      std::memcpy(sorted.data() + (number - first) * row_size_,
                  rows.data() + at + kNumberSize, row_size_);
    }
    file.stream().write(sorted.data(), std::streamsize(sorted.size()));
  }
  file.commit();
}

} // namespace pcl_semantic
