// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/crc.hpp>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>

namespace pcl_semantic {

/** \brief A number as four big-endian bytes, as in PNG. */
inline std::string
bigEndian(std::uint32_t number)
{
  std::string bytes;
  for (const int shift : {24, 16, 8, 0})
    bytes += char(number >> shift);
  return bytes;
}

/** \brief Writes a PNG whose header states 30000 x 30000 grey pixels, with 100 kB of
 * invalid data. A decoder reports damage. */
inline void
writeHugePng(const std::string& path)
{
  std::string file = "\x89PNG\r\n\x1A\n";
  const auto add = [&](const std::string& name, const std::string& data) {
    boost::crc_32_type crc;
    crc.process_bytes((name + data).data(), name.size() + data.size());
    file +=
        bigEndian(std::uint32_t(data.size())) + name + data + bigEndian(crc.checksum());
  };
  const std::string grey("\x08\0\0\0\0", 5);
  add("IHDR", bigEndian(30000) + bigEndian(30000) + grey);
  add("IDAT", std::string(100000, '\0'));
  add("IEND", "");
  std::ofstream(path, std::ios::binary) << file;
}

} // namespace pcl_semantic
