// SPDX-License-Identifier: BSD-3-Clause

// Preloaded into a program by ServedProgram: main() waits for command lines and runs
// each in a fork of the process. Loading the libraries of a program takes longer than
// most of its runs in the tests.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace {

using Main = int (*)(int, char**, char**);
using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);

constexpr int requests = 3; // the descriptor of the socket

bool
readAll(void* to, std::size_t size)
{
  auto* bytes = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t count = ::read(requests, bytes, size);
    if (count <= 0)
      return false;
    bytes += count;
    size -= std::size_t(count);
  }
  return true;
}

// The output file and the words of the command line.
std::vector<std::string>
readRequest()
{
  std::uint32_t size = 0;
  if (!readAll(&size, sizeof(size)))
    return {};
  std::string text(size, '\0');
  if (!readAll(text.data(), text.size()))
    return {};
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < text.size();) {
    words.emplace_back(text.c_str() + begin);
    begin += words.back().size() + 1;
  }
  return words;
}

void
printTo(const std::string& path)
{
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(file, STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  ::close(file);
  ::close(requests);
}

} // namespace

extern "C" int
__libc_start_main(Main program, int argc, char** argv, void (*init)(), void (*fini)(),
                  void (*rtld_fini)(), void* stack_end)
{
  const auto start = reinterpret_cast<Start>(::dlsym(RTLD_NEXT, "__libc_start_main"));
  static std::vector<std::string> words;
  for (words = readRequest(); words.size() > 1; words = readRequest()) {
    const pid_t child = ::fork();
    if (child == 0)
      break;
    int status = -1;
    ::waitpid(child, &status, 0);
    if (::write(requests, &status, sizeof(status)) != sizeof(status))
      ::_exit(0);
  }
  if (words.size() < 2)
    ::_exit(0);
  printTo(words[0]);
  ::unsetenv("LD_PRELOAD");
  // The environment must follow the arguments in memory.
  static std::vector<char*> pointers;
  for (std::size_t i = 1; i < words.size(); ++i)
    pointers.push_back(words[i].data());
  argc = int(pointers.size());
  pointers.push_back(nullptr);
  for (char** each = environ; *each; ++each)
    pointers.push_back(*each);
  pointers.push_back(nullptr);
  argv = pointers.data();
  return start(program, argc, argv, init, fini, rtld_fini, stack_end);
}
