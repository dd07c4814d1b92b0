/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include <unistd.h>

namespace pcl_semantic {

/** \brief A folder of the running test that vanishes with it. */
class ScratchFolder {
public:
  ScratchFolder()
  {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("pcl_semantic_") + info->test_suite_name() + "_" +
             info->name() + "_" + std::to_string(getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }

  ~ScratchFolder() { std::filesystem::remove_all(path_); }

  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string
  operator/(const std::string& name) const
  {
    return (path_ / name).string();
  }

  std::string
  str() const
  {
    return path_.string();
  }

private:
  std::filesystem::path path_;
};

/** \brief What the exception E of \a action says; empty if none comes. */
template <typename E = BadInputException, typename Action>
std::string
complaint(const Action& action)
{
  try {
    action();
  }
  catch (const E& error) {
    return error.what();
  }
  return "";
}

/** \brief Expects one line that holds \a part. */
inline void
expectSays(const std::string& message, const std::string& part)
{
  EXPECT_NE(message.find(part), std::string::npos) << "'" << message << "'";
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

} // namespace pcl_semantic
