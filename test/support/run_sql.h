// SPDX-License-Identifier: BSD-3-Clause

// Changes an archive as another SQLite program would.

#pragma once

#include <gtest/gtest.h>

#include <sqlite3.h>

#include <string>

namespace pcl_semantic {

/** \brief Opens a file as any SQLite program does, runs statements and closes it, which
 * moves FILE-wal into it. \return SQLite's error; empty = none */
inline std::string
runSql(const std::string& path, const std::string& sql)
{
  sqlite3* connection = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &connection), SQLITE_OK);
  const int code = sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr);
  const std::string error = code == SQLITE_OK ? "" : sqlite3_errmsg(connection);
  sqlite3_close(connection);
  return error;
}

} // namespace pcl_semantic
