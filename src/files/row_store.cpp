// SPDX-License-Identifier: BSD-3-Clause
#include "row_store.h"

#include "core/fail.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace pcl_semantic {

namespace {

// Memory of the rows that are not on disk yet, of all buckets.
constexpr std::size_t kBufferSize = std::size_t(64) << 20;

int
openUnnamed(const std::string& folder)
{
#ifdef O_TMPFILE
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0)
    return file;
#endif
  std::string name = folder + "/.rows.XXXXXX"; // for file systems without O_TMPFILE
  const int named = ::mkstemp(name.data());
  if (named >= 0)
    ::unlink(name.c_str());
  return named;
}

// Reads or writes all bytes; false if that fails.
template <typename Transfer, typename Byte>
bool
transferAll(Transfer transfer, int file, Byte* bytes, std::size_t size,
            std::uint64_t offset)
{
  while (size > 0) {
    const ssize_t done = transfer(file, bytes, size, off_t(offset));
    if (done < 0 && errno == EINTR)
      continue;
    if (done <= 0)
      return false;
    bytes += done;
    size -= std::size_t(done);
    offset += std::uint64_t(done);
  }
  return true;
}

} // namespace

RowStore::RowStore(std::string folder, std::size_t row_size, std::size_t buckets)
    : folder_(folder.empty() ? "." : std::move(folder)), row_size_(row_size),
      buckets_(buckets)
{
  if (row_size == 0 || buckets == 0)
    badParameter("rows of ", row_size, " bytes in ", buckets, " buckets");
  const std::size_t size = std::clamp<std::size_t>(kBufferSize / buckets, 1, 1 << 20);
  chunk_size_ = std::max<std::size_t>(size / row_size, 1) * row_size;
  file_ = openUnnamed(folder_);
  if (file_ < 0)
    refuse();
}

RowStore::~RowStore()
{
  ::close(file_);
}

void
RowStore::append(std::size_t bucket, const std::uint8_t* row)
{
  Bucket& to = buckets_[bucket];
  to.last.insert(to.last.end(), row, row + row_size_);
  if (to.last.size() == chunk_size_)
    flush(to);
}

void
RowStore::flush(Bucket& bucket)
{
  const auto* const bytes = bucket.last.data();
  if (!transferAll(::pwrite, file_, bytes, chunk_size_, end_))
    refuse();
  bucket.chunks.push_back(end_);
  end_ += chunk_size_;
  bucket.last.clear();
}

std::vector<std::uint8_t>
RowStore::read(std::size_t bucket) const
{
  const Bucket& from = buckets_[bucket];
  const std::size_t stored = from.chunks.size() * chunk_size_;
  std::vector<std::uint8_t> rows(stored + from.last.size());
  for (std::size_t c = 0; c < from.chunks.size(); ++c)
    if (!transferAll(::pread, file_, rows.data() + c * chunk_size_, chunk_size_,
                     from.chunks[c]))
      refuse();
  std::copy(from.last.begin(), from.last.end(), rows.begin() + std::ptrdiff_t(stored));
  return rows;
}

void
RowStore::refuse() const
{
  fail<OutputException>(folder_,
                        ": a temporary file cannot be used: ", std::strerror(errno));
}

} // namespace pcl_semantic
