// SPDX-License-Identifier: BSD-3-Clause
#include "ranks.h"

#ifdef PCL_SEMANTIC_WITH_MPI

#include <boost/mpi.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#endif

namespace pcl_semantic::tool {

#ifdef PCL_SEMANTIC_WITH_MPI

namespace {

namespace mpi = boost::mpi;

constexpr int request = 1, answer = 2; // tags

// MPI started without a launcher would still search the network.
bool
isStartedByMpi()
{
  for (const char* const name :
       {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"})
    if (std::getenv(name))
      return true;
  return false;
}

// Gives numbers to the other ranks until each was told that none are left.
class Counter {
public:
  Counter(const mpi::communicator& world, std::size_t count)
      : world_(world), count_(count), server_([this] { serve(); })
  {}

  ~Counter()
  {
    is_given_up_ = true;
    server_.join();
  }

  std::size_t
  next()
  {
    const std::size_t number = next_++;
    return number < count_ ? number : count_;
  }

  /** \brief Waits until all ranks were told that no tasks are left. */
  void
  wait()
  {
    while (waiting_ > 0)
      std::this_thread::sleep_for(pause_);
  }

private:
  void
  serve()
  {
    while (waiting_ > 0 && !is_given_up_) {
      const auto status = world_.iprobe(mpi::any_source, request);
      if (!status) { // waiting in MPI would keep a processor busy
        std::this_thread::sleep_for(pause_);
        continue;
      }
      world_.recv(status->source(), request);
      const std::size_t number = next();
      world_.send(status->source(), answer, number);
      if (number == count_)
        --waiting_;
    }
  }

  static constexpr std::chrono::milliseconds pause_{2};

  const mpi::communicator& world_;
  const std::size_t count_;
  std::atomic<std::size_t> next_{0};
  std::atomic<int> waiting_{world_.size() - 1}; // ranks
  std::atomic<bool> is_given_up_{false};
  std::thread server_; // last: it uses the other members
};

} // namespace

struct Ranks::Processes {
  Processes(int& argc, char**& argv)
      : environment(argc, argv, mpi::threading::multiple, false)
  {
    if (mpi::environment::thread_level() < mpi::threading::multiple)
      throw std::runtime_error("this MPI library does not support threads");
  }

  mpi::environment environment;
  mpi::communicator world;
};

Ranks::Ranks(int& argc, char**& argv)
{
  if (isStartedByMpi())
    processes_ = std::make_unique<Processes>(argc, argv);
}

int
Ranks::rank() const
{
  return processes_ ? processes_->world.rank() : 0;
}

int
Ranks::size() const
{
  return processes_ ? processes_->world.size() : 1;
}

void
Ranks::wait() const
{
  if (!processes_)
    return;
  // A barrier; waiting in MPI would keep a processor busy.
  MPI_Request arrived;
  MPI_Ibarrier(processes_->world, &arrived);
  for (int all = 0; !all;) {
    MPI_Test(&arrived, &all, MPI_STATUS_IGNORE);
    if (!all)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void
Ranks::broadcast(std::vector<std::string>& texts) const
{
  if (processes_)
    mpi::broadcast(processes_->world, texts, 0);
}

std::vector<std::string>
Ranks::gather(const std::vector<std::string>& texts) const
{
  if (!processes_)
    return texts;
  std::vector<std::vector<std::string>> each;
  mpi::all_gather(processes_->world, texts, each);
  std::vector<std::string> all;
  for (const std::vector<std::string>& some : each)
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

void
Ranks::share(std::size_t count, const std::function<void(std::size_t)>& task) const
{
  if (size() == 1) {
    for (std::size_t i = 0; i < count; ++i)
      task(i);
    return;
  }
  const mpi::communicator& world = processes_->world;
  if (rank() == 0) {
    Counter counter(world, count);
    for (std::size_t i = counter.next(); i < count; i = counter.next())
      task(i);
    counter.wait();
  }
  else
    while (true) {
      std::size_t i = 0;
      world.send(0, request);
      world.recv(0, answer, i);
      if (i == count)
        break;
      task(i);
    }
  wait();
}

void
Ranks::stop(int code) const
{
  if (size() > 1)
    processes_->environment.abort(code);
}

#else

struct Ranks::Processes {};

Ranks::Ranks(int& /*argc*/, char**& /*argv*/)
{}

int
Ranks::rank() const
{
  return 0;
}

int
Ranks::size() const
{
  return 1;
}

void
Ranks::wait() const
{}

void
Ranks::broadcast(std::vector<std::string>& /*texts*/) const
{}

std::vector<std::string>
Ranks::gather(const std::vector<std::string>& texts) const
{
  return texts;
}

void
Ranks::share(std::size_t count, const std::function<void(std::size_t)>& task) const
{
  for (std::size_t i = 0; i < count; ++i)
    task(i);
}

void
Ranks::stop(int /*code*/) const
{}

#endif

Ranks::~Ranks() = default;

} // namespace pcl_semantic::tool
