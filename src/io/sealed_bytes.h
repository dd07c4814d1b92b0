// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/byte_reader.h>

#include <memory>

namespace pcl_semantic {

/** \brief Compresses bytes into one zstd frame that holds their size and a checksum of
 * them. The same bytes give the same frame. For one thread at a time. */
class Sealer {
public:
  Sealer();
  ~Sealer();

  /** \throws std::bad_alloc */
  Bytes seal(const Bytes& content);

private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/** \brief The bytes that were sealed.
 * \param[in] data, size the frame
 * \param[in] most bytes that the content may have; no more memory is taken
 * \throws BadInputException if the frame is damaged, lacks its size or checksum, or
 * something lies behind it */
Bytes unseal(const void* data, std::size_t size, std::size_t most);

} // namespace pcl_semantic
