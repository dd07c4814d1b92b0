// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief The parallel processes started by mpirun or Slurm: one without either, or
 * without MPI in the build. All processes must call all methods in the same order,
 * unless stated otherwise. */
class Ranks {
public:
  /** \brief Must be called once, before any other thread starts. */
  Ranks(int& argc, char**& argv);
  ~Ranks();

  int rank() const;

  int size() const;

  /** \brief Waits for all processes. */
  void wait() const;

  /** \brief Sends rank 0's texts to all processes. */
  void broadcast(std::vector<std::string>& texts) const;

  /** \brief Gathers the texts of all processes, in order of ranks, on all processes. */
  std::vector<std::string> gather(const std::vector<std::string>& texts) const;

  /** \brief Runs the tasks 0, 1, ... count - 1, each once, on any idle process; waits
   * for the last. An exception of a task leaves this process, while the others wait:
   * call stop(). */
  void share(std::size_t count, const std::function<void(std::size_t)>& task) const;

  /** \brief Ends all processes, called by a failed one; returns if there are no
   * others. */
  void stop(int code) const;

private:
  struct Processes;
  std::unique_ptr<Processes> processes_; // null: one process
};

} // namespace pcl_semantic::tool
