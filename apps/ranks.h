// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief The processes that work together, as mpirun or Slurm has started them: one,
 * where neither has, or where it is built without MPI. All methods but those that say
 * otherwise are called by all of them, in the same order. */
class Ranks {
public:
  /** \brief Once, before any other thread begins. */
  Ranks(int& argc, char**& argv);
  ~Ranks();

  int rank() const;

  int size() const;

  /** \brief Waits for all. */
  void wait() const;

  /** \brief Gives what rank 0 has to all. */
  void broadcast(std::vector<std::string>& texts) const;

  /** \brief Gathers a list of texts from each process, in the order of their ranks, for
   * all. */
  std::vector<std::string> gather(const std::vector<std::string>& texts) const;

  /** \brief Runs the tasks 0, 1, ... count - 1, each once, on any idle process; waits
   * for the last. What a task throws leaves it, and leaves the others waiting: stop().
   */
  void share(std::size_t count, const std::function<void(std::size_t)>& task) const;

  /** \brief Ends all of them, by one that failed; returns if there is no other. */
  void stop(int code) const;

private:
  struct Processes;
  std::unique_ptr<Processes> processes_; // null: one
};

} // namespace pcl_semantic::tool
