// SPDX-License-Identifier: BSD-3-Clause
#include "network_trial.h"
#include "image_tool.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/labelling/network_predictor.h>

#include "core/fail.h"

#include <opencv2/core.hpp>

#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <set>
#include <thread>
#include <tuple>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

constexpr const char* mode = "--try-network";

constexpr std::chrono::seconds patience{120};

void
limitResources()
{
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
#if !defined(__SANITIZE_ADDRESS__) // it reserves more memory than any machine has
  const rlim_t memory =
      rlim_t(::sysconf(_SC_PHYS_PAGES)) * rlim_t(::sysconf(_SC_PAGESIZE)) / 4 * 3;
  rlimit limit{};
  if (::getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur > memory) {
    limit.rlim_cur = memory;
    ::setrlimit(RLIMIT_DATA, &limit);
  }
#endif
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGKILL); // otherwise the trial would outlive it
#endif
}

// Starts this program again without output. \return 0 if this fails
pid_t
start(const std::vector<std::string>& arguments)
{
  std::vector<char*> pointers;
  for (const std::string& argument : arguments)
    pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_RDWR, 0);
  pid_t process = 0;
  const int error = ::posix_spawn(&process, "/proc/self/exe", &actions, nullptr,
                                  pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return error == 0 ? process : 0;
}

// Like waitpid(). \return false after a timeout: it kills the process
bool
waitFor(pid_t process, int& status)
{
  const auto end = std::chrono::steady_clock::now() + patience;
  while (::waitpid(process, &status, WNOHANG) == 0) {
    if (interrupted() || std::chrono::steady_clock::now() > end) {
      ::kill(process, SIGKILL);
      ::waitpid(process, &status, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

// Whether the user interrupted both processes.
bool
isInterrupt(int status)
{
  return WIFSIGNALED(status) &&
         (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM ||
          WTERMSIG(status) == SIGHUP);
}

void
tryNetwork(const std::string& description, const std::string& model,
           const std::string& engine)
{
  static std::set<std::tuple<std::string, std::string, std::string>> tried;
  const auto network = std::make_tuple(description, model, engine);
  if (tried.count(network) > 0)
    return;
  std::signal(SIGCHLD,
              SIG_DFL); // with an inherited SIG_IGN, waitpid() would fail
  const pid_t process = start(
      {"pcl_semantic_" + std::string(mode + 2), mode, description, model, engine});
  if (process == 0)
    return; // for example without /proc
  const std::string name = model.empty() ? description : model;
  int status = 0;
  const bool has_ended = waitFor(process, status);
  if (isInterrupt(status) || interrupted())
    throw Exit{exit_interrupted};
  if (!has_ended)
    fail<BadModelException>(name, ": the network has not labelled an image within ",
                            patience.count(), " s");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    fail<BadModelException>(
        name, ": the test run of the network was killed; is there enough memory?");
  if (WIFSIGNALED(status))
    fail<BadModelException>(name, ": the network crashes the program that loads it (",
                            ::strsignal(WTERMSIG(status)),
                            "); it is damaged, or not for ",
                            engine.empty() ? "this engine" : engine);
  if (WEXITSTATUS(status) == exit_out_of_memory)
    throw std::bad_alloc();
  tried.insert(network);
}

} // namespace

OpenedNetwork
openTriedNetwork(const std::string& description, const std::string& model,
                 const std::string& engine)
{
  tryNetwork(description, model, engine);
  return openNetwork(description, model, engine);
}

std::optional<int>
runAsNetworkTrial(int argc, char** argv)
{
  if (argc != 5 || std::strcmp(argv[1], mode) != 0)
    return std::nullopt;
  limitResources();
  return runWithImages(argv[0], [&] {
    const NetworkDescription network = readNetworkDescription(argv[2]);
    const OpenedNetwork opened = openNetwork(argv[2], argv[3], argv[4]);
    const cv::Mat image(network.input_height, network.input_width, CV_8UC3,
                        cv::Scalar::all(128));
    opened.predictor->predict(image, 0);
    return int(exit_done);
  });
}

} // namespace pcl_semantic::tool
