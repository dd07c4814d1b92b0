// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/exceptions.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Base of everything this module throws: `what()` is one line in the user's
 * terms that says what is wrong, where (file, line, frame) and what was expected.
 * Control characters of what it cites are escaped. */
class Exception : public pcl::PCLException {
public:
  /** \brief The arguments that PCL_THROW_EXCEPTION gives. */
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

/** \brief A parameter or argument outside its range (tools exit with 2). */
class InvalidParameterException : public Exception {
public:
  using Exception::Exception;
};

/** \brief A file or a value in it that cannot be used (tools exit with 3). */
class BadInputException : public Exception {
public:
  using Exception::Exception;
};

/** \brief A network that cannot be loaded or answers nonsense (tools exit with 4). */
class BadModelException : public Exception {
public:
  using Exception::Exception;
};

/** \brief A result that could not be written (tools exit with 5). */
class OutputException : public Exception {
public:
  using Exception::Exception;
};

} // namespace pcl_semantic
