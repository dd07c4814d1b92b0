// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/npy_file.h>

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <new>
#include <regex>

#include <zstd.h>

namespace pcl_semantic {

namespace {

struct Header {
  std::string text;
  std::size_t data_offset = 0;
};

// The header of format versions 1 and 2: magic, version, length, a Python dictionary.
Header
readHeader(const std::string& path, const std::vector<std::uint8_t>& bytes)
{
  static constexpr std::uint8_t magic[] = {0x93, 'N', 'U', 'M', 'P', 'Y'};
  if (bytes.size() < 12 || std::memcmp(bytes.data(), magic, sizeof(magic)) != 0)
    badInput(path, ": is not a NumPy file");
  const int version = bytes[6];
  if (version != 1 && version != 2)
    badInput(path, ": has NumPy format version ", version, ", expected 1 or 2");
  std::size_t length = bytes[8] + 256u * bytes[9];
  std::size_t offset = 10;
  if (version == 2) {
    length += 65536u * bytes[10] + 16777216u * std::size_t(bytes[11]);
    offset = 12;
  }
  if (length > bytes.size() - offset)
    badInput(path, ": the NumPy header is longer than the file");
  // NumPy writes 128 bytes; the regular expressions recurse per character.
  constexpr std::size_t longest = 1024;
  if (length > longest)
    badInput(path, ": the NumPy header has ", length, " bytes, expected at most ",
             longest);
  return {
      std::string(bytes.begin() + long(offset), bytes.begin() + long(offset + length)),
      offset + length};
}

// A header of format version 1 that ends at byte 128, as NumPy aligns it.
std::string
headerText(const std::string& type, const std::string& shape)
{
  constexpr std::size_t before = 10; // magic, version, length
  std::string text =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  text.resize(128 - before - 1, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", before) + text + '\n';
}

std::size_t
bytesOf(NpyType type)
{
  return type == NpyType::float32 ? 4 : type == NpyType::float16 ? 2 : 1;
}

bool
isCompressed(const std::string& path)
{
  return std::filesystem::path(path).extension() == ".zst";
}

// \param[in] most values of the array
std::vector<std::uint8_t>
unpacked(const std::string& path, const std::vector<std::uint8_t>& frame,
         std::size_t most)
{
  constexpr std::size_t longest_header = 2048;
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    badInput(path, ": is no file of zstd that states its size");
  if (size > most * sizeof(float) + longest_header)
    badInput(path, ": holds ", size, " bytes, expected at most ",
             most * sizeof(float) + longest_header);
  std::vector<std::uint8_t> bytes(size);
  const std::size_t got =
      ZSTD_decompress(bytes.data(), bytes.size(), frame.data(), frame.size());
  if (ZSTD_isError(got) || got != bytes.size())
    badInput(path, ": is damaged: ",
             ZSTD_isError(got) ? ZSTD_getErrorName(got) : "it is too short");
  return bytes;
}

std::string
packed(const std::string& bytes)
{
  constexpr int level = 3;
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(frame.data(), frame.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size)) // the frame is large enough, so this is a lack of memory
    throw std::bad_alloc();
  frame.resize(size);
  return frame;
}

} // namespace

NpyArray
readNpy(const std::string& path, std::size_t most)
{
  const std::vector<std::uint8_t> bytes =
      isCompressed(path) ? unpacked(path, readBytes(path), most) : readBytes(path);
  const Header header = readHeader(path, bytes);

  std::smatch match;
  if (!std::regex_search(header.text, match,
                         std::regex("'descr'\\s*:\\s*'([^'\\n]*)'")) ||
      (match[1] != "<f4" && match[1] != "<f2" && match[1] != "|u1"))
    badInput(path, ": has type '", match[1],
             "', expected '<f4', '<f2' or '|u1' (float32, float16, uint8)");
  const NpyType type = match[1] == "<f4"   ? NpyType::float32
                       : match[1] == "<f2" ? NpyType::float16
                                           : NpyType::uint8;
  if (!std::regex_search(header.text, std::regex("'fortran_order'\\s*:\\s*False")))
    badInput(path, ": is in Fortran order, expected C order");
  if (!std::regex_search(
          header.text, match,
          std::regex(
              "'shape'\\s*:\\s*\\((\\d{1,6}),\\s*(\\d{1,6}),\\s*(\\d{1,6}),?\\s*\\)")))
    badInput(path, ": expected an array of three axes (rows, columns, classes)");
  NpyArray array;
  array.height = std::stoi(match[1]);
  array.width = std::stoi(match[2]);
  array.depth = std::stoi(match[3]);
  const std::size_t count =
      std::size_t(array.height) * std::size_t(array.width) * std::size_t(array.depth);
  const std::size_t expected = count * bytesOf(type);
  if (bytes.size() - header.data_offset != expected)
    badInput(path, ": has ", bytes.size() - header.data_offset,
             " bytes of data, expected ", expected);
  array.values.resize(array.depth, Eigen::Index(array.height) * array.width);
  const std::uint8_t* const data = bytes.data() + header.data_offset;
  float* const values = array.values.data();
  array.is_rounded = type == NpyType::uint8;
  if (type == NpyType::float32)
    std::memcpy(values, data, expected);
  else if (type == NpyType::uint8)
    for (std::size_t i = 0; i < count; ++i)
      values[i] = float(data[i]) / 255.0f;
  else
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::half value;
      std::memcpy(static_cast<void*>(&value), data + 2 * i, 2);
      values[i] = float(value);
    }
  return array;
}

void
writeNpy(const std::string& path, int height, int width, int depth, const float* values,
         NpyType type)
{
  const std::size_t count =
      std::size_t(height) * std::size_t(width) * std::size_t(depth);
  std::string bytes = headerText(type == NpyType::float32   ? "<f4"
                                 : type == NpyType::float16 ? "<f2"
                                                            : "|u1",
                                 std::to_string(height) + ", " + std::to_string(width) +
                                     ", " + std::to_string(depth));
  const auto append = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  if (type == NpyType::float16) {
    const std::vector<Eigen::half> halves(values, values + count);
    append(halves.data(), count * sizeof(Eigen::half));
  }
  else if (type == NpyType::uint8) {
    std::vector<std::uint8_t> rounded(count);
    std::transform(values, values + count, rounded.begin(), [](float value) {
      return std::uint8_t(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
    });
    append(rounded.data(), count);
  }
  else
    append(values, count * sizeof(float));
  writeTextFile(path, isCompressed(path) ? packed(bytes) : bytes);
}

} // namespace pcl_semantic
