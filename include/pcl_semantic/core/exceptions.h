// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/exceptions.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Base of all exceptions of this library. `what()` is one line in the user's
 * terms: the error, its location (file, line, frame) and the expected input. Control
 * characters in quoted input are escaped. */
class Exception : public pcl::PCLException {
public:
  /** \brief Takes the arguments of PCL_THROW_EXCEPTION. */
  explicit Exception(const std::string& message, const char* source_file = nullptr,
                     const char* function = nullptr, unsigned source_line = 0);

  const char*
  what() const noexcept override
  {
    return message_.c_str();
  }

private:
  std::string message_;
};

/** \brief A parameter or argument is outside its range (programs exit with 2). */
class InvalidParameterException : public Exception {
public:
  using Exception::Exception;
};

/** \brief A file or a value in it cannot be used (programs exit with 3). */
class BadInputException : public Exception {
public:
  using Exception::Exception;
};

/** \brief A network cannot be loaded or its output is invalid (programs exit with 4).
 */
class BadModelException : public Exception {
public:
  using Exception::Exception;
};

/** \brief A result could not be written (programs exit with 5). */
class OutputException : public Exception {
public:
  using Exception::Exception;
};

} // namespace pcl_semantic
