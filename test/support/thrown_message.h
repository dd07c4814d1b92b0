// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

} // namespace pcl_semantic
