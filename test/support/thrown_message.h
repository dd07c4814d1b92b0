// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <exception>
#include <string>

namespace pcl_semantic {

/** \brief Runs \a body, which must throw exactly an \a Error with a single-line
 * message, and returns the message. Otherwise the test fails and the result is empty.
 */
template <typename Error, typename Body>
std::string
thrownMessage(Body&& body)
{
  try {
    body();
  }
  catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_FALSE(message.empty());
    return message;
  }
  catch (const std::exception& error) {
    ADD_FAILURE() << "another exception came: " << error.what();
    return {};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

/** \brief EXPECT that \a message contains \a part. */
inline ::testing::AssertionResult
holds(const std::string& message, const std::string& part)
{
  if (message.find(part) != std::string::npos)
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << message << "' lacks '" << part << "'";
}

/** \brief EXPECT that \a body throws exactly an \a Error whose message contains \a
 * part. */
template <typename Error, typename Body>
::testing::AssertionResult
throws(const std::string& part, Body&& body)
{
  return holds(thrownMessage<Error>(body), part);
}

/** \brief The same, as a statement; a failure names the caller's line. */
template <typename Error, typename Body>
void
expectRefusal(const std::string& part, Body&& body, const char* file = __builtin_FILE(),
              int line = __builtin_LINE())
{
  const ::testing::ScopedTrace trace(file, line, part);
  EXPECT_TRUE(throws<Error>(part, body));
}

template <typename Body>
void
expectBadInput(const std::string& part, Body&& body,
               const char* file = __builtin_FILE(), int line = __builtin_LINE())
{
  expectRefusal<BadInputException>(part, body, file, line);
}

template <typename Body>
void
expectBadParameter(const std::string& part, Body&& body,
                   const char* file = __builtin_FILE(), int line = __builtin_LINE())
{
  expectRefusal<InvalidParameterException>(part, body, file, line);
}

} // namespace pcl_semantic
