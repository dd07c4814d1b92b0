// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcl_semantic {

/** \brief A field of a protocol buffer message. */
struct WireField {
  enum Type { varint = 0, fixed64 = 1, bytes = 2, fixed32 = 5 };

  std::uint32_t number = 0;
  Type type = varint;
  std::uint64_t value = 0;            ///< of a varint
  const std::uint8_t* data = nullptr; ///< of the other types
  std::size_t size = 0;               ///< of \a data [bytes]
};

/** \brief Reads the fields of a protocol buffer message one after the other, never
 * beyond its end. */
class WireReader {
public:
  /** \param[in] data message; has to outlive the reader
   * \param[in] path for messages */
  WireReader(const std::uint8_t* data, std::size_t size, const std::string& path)
      : at_(data), end_(data + size), path_(path)
  {}

  /** \brief The message in a field of type bytes.
   * \throws BadModelException if it is of another type */
  WireReader(const WireField& field, const std::string& path);

  /** \return false at the end of the message
   * \throws BadModelException if the bytes are no well-formed message */
  bool next(WireField& field);

  bool
  atEnd() const
  {
    return at_ == end_;
  }

  /** \throws BadModelException if the bytes end before it does, or it is too long */
  std::uint64_t readVarint();

private:
  void take(std::uint64_t size, WireField& field);

  const std::uint8_t* at_;
  const std::uint8_t* end_;
  const std::string& path_;
};

/** \brief A field of another type than its number says would be passed over by the
 * reader proper. \throws BadModelException */
void requireType(const WireField& field, WireField::Type type, const std::string& path);

/** \brief The text of a field of type bytes. */
std::string textOf(const WireField& field);

/** \brief A text from the file as messages may show it: one line, printable, short. */
std::string printable(const std::string& text);

} // namespace pcl_semantic
