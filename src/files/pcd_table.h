// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/cloud_file.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace pcl_semantic {

/** \brief The name of PCL's padding, of which a table may have any number. */
constexpr const char* kPadding = "_";

/** \brief Of a field in a row [bytes]. */
std::size_t offsetOf(const PcdTable& table, std::size_t field);

/** \brief Whether a table can be a file: fields of different names that can be, and as
 * many data as they need.
 * \param[in] path for the message
 * \throws InvalidParameterException if it cannot */
void checkTable(const std::string& path, const PcdTable& table);

/** \brief What \a use gives for a zero of the type that a field holds. */
template <typename Use>
auto
withTypeOf(const PcdField& field, Use&& use)
{
  const bool is_signed = field.type == 'I', is_float = field.type == 'F';
  switch (field.size) {
  case 1:
    return is_signed ? use(std::int8_t()) : use(std::uint8_t());
  case 2:
    return is_signed ? use(std::int16_t()) : use(std::uint16_t());
  case 4:
    if (is_float)
      return use(float());
    return is_signed ? use(std::int32_t()) : use(std::uint32_t());
  default:
    if (is_float)
      return use(double());
    return is_signed ? use(std::int64_t()) : use(std::uint64_t());
  }
}

} // namespace pcl_semantic
