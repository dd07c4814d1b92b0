// SPDX-License-Identifier: BSD-3-Clause
#include "tool.h"
#include "messages.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/printable.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>

#include <pcl/console/print.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <set>
#include <string_view>

#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#endif

namespace pcl_semantic::tool {

namespace {

volatile std::sig_atomic_t interrupt_count = 0;
volatile std::sig_atomic_t interrupts_that_end = 2;

// Only async-signal-safe functions such as write() and _exit() may be called here.
extern "C" void
onInterrupt(int)
{
  interrupt_count = interrupt_count + 1;
  if (interrupt_count >= interrupts_that_end)
    _exit(exit_interrupted);
  constexpr std::string_view text =
      "\ninterrupted: the map is being finished; the third Ctrl-C ends at once\n";
  if (interrupt_count == 1 && interrupts_that_end > 2 &&
      ::write(STDERR_FILENO, text.data(), text.size()) < 0)
    return; // no reader
}

// Finds a class of --ignore by number or name.
Label
ignoredLabel(const std::string& word, const LabelSet& label_set)
{
  int number = 0;
  const auto [rest, error] =
      std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc() && rest == word.data() + word.size()) {
    if (number >= 1 && number <= label_set.size())
      return static_cast<Label>(number);
  }
  else if (const Label label = label_set.find(word))
    return label;
  fail<InvalidParameterException>("--ignore: '", word,
                                  "' is no class of the label set");
}

int
report(const std::string& name, const std::string& message, ExitCode code)
{
  std::cerr << name << ": " << printable(message) << std::endl;
  return code;
}

int
codeOf(const std::function<int()>& body)
{
  try {
    return body();
  }
  catch (const Exit& exit) {
    return exit.code;
  }
}

} // namespace

int
run(const std::string& name, const std::function<int()>& body)
{
  manner().name = name;
  // PCL would otherwise print its own messages.
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
  // A failed write becomes an error message instead of a signal.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const int code = codeOf(body);
    if (!std::cout.flush())
      return report(name, "standard output cannot be written", exit_output_failed);
    return code;
  }
  catch (const InvalidParameterException& error) {
    return report(name, error.what(), exit_usage);
  }
  catch (const BadModelException& error) {
    return report(name, error.what(), exit_bad_model);
  }
  catch (const OutputException& error) {
    return report(name, error.what(), exit_output_failed);
  }
  catch (const std::bad_alloc&) {
    return report(name, "out of memory", exit_out_of_memory);
  }
  catch (const std::exception& error) {
    return report(name, error.what(), exit_bad_input);
  }
}

void
forEachStep(const std::string& what, std::size_t steps,
            const std::function<void(std::size_t)>& step, const std::string& unit)
{
  catchInterrupts();
  ProgressBar progress(what, steps, unit);
  for (std::size_t i = 0; i < steps; ++i) {
    step(i);
    if (interrupted())
      throw Exit{exit_interrupted};
    progress.step();
  }
}

void
requireOutput(const std::string& path, const std::string& extension)
{
  if (path.empty())
    return;
  if (std::filesystem::path(path).extension() != extension)
    fail<InvalidParameterException>(path, ": expected a name that ends in ", extension);
  const auto folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!folder.empty() && !std::filesystem::is_directory(folder, error))
    fail<OutputException>(path, ": cannot be written: there is no folder ", folder);
}

void
warnOfOtherFiles(const std::string& folder, const std::vector<std::string>& written)
{
  namespace fs = std::filesystem;
  std::set<fs::path> names, extensions;
  for (const std::string& path : written) {
    names.insert(fs::path(path).filename());
    extensions.insert(fs::path(path).extension());
  }
  std::size_t others = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    others += extensions.count(entry.path().extension()) &&
              !names.count(entry.path().filename());
  if (others > 0)
    warn(folder + ": holds " + std::to_string(others) + " other " +
         extensions.begin()->string() + " file" + (others > 1 ? "s" : "") +
         ", which this run keeps; of an earlier run?");
}

bool
areSameFile(const std::string& a, const std::string& b)
{
  namespace fs = std::filesystem;
  std::error_code error;
  return !a.empty() && !b.empty() &&
         (fs::absolute(a, error).lexically_normal() ==
              fs::absolute(b, error).lexically_normal() ||
          fs::equivalent(a, b, error));
}

void
refuseSameFiles(const std::vector<std::string>& inputs,
                const std::vector<std::string>& outputs)
{
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    std::vector<std::string> others = inputs;
    others.insert(others.end(), outputs.begin() + long(i) + 1, outputs.end());
    for (const std::string& other : others)
      if (areSameFile(outputs[i], other))
        fail<InvalidParameterException>(outputs[i],
                                        ": is given as an output and a second time");
  }
}

std::vector<Label>
evaluatedClasses(const std::optional<std::string>& ignored, const LabelSet& label_set)
{
  std::vector<Label> left_out;
  if (!ignored)
    left_out = {label_set.find("sky"), label_set.find("pedestrian"),
                label_set.find("cyclist")};
  else if (*ignored != "none") {
    for (const std::string& word : splitAtCommas(*ignored))
      left_out.push_back(ignoredLabel(word, label_set));
  }
  std::vector<Label> evaluated;
  for (int label = 1; label <= label_set.size(); ++label)
    if (std::find(left_out.begin(), left_out.end(), label) == left_out.end())
      evaluated.push_back(static_cast<Label>(label));
  if (evaluated.empty())
    fail<InvalidParameterException>("--ignore leaves no class");
  return evaluated;
}

void
catchInterruptsOfMap()
{
  interrupts_that_end = 3;
  catchInterrupts();
}

void
catchInterrupts()
{
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
  if (std::signal(SIGHUP, onInterrupt) == SIG_IGN)
    std::signal(SIGHUP, SIG_IGN); // nohup
}

bool
interrupted()
{
  return interrupt_count > 0;
}

void
keepFreedMemory()
{
#ifdef __GLIBC__
  constexpr int more_than_any = 1 << 30; // [bytes]
  mallopt(M_MMAP_THRESHOLD, more_than_any);
  mallopt(M_TRIM_THRESHOLD, more_than_any);
  mallopt(M_TOP_PAD, 1 << 26);
  // Requests huge pages for the next heap. They use no memory until written to.
  constexpr std::size_t size = std::size_t(1) << 29, page = std::size_t(1) << 21;
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY)
    return;
  if (void* const heap = std::malloc(size)) {
    const std::uintptr_t begin = (std::uintptr_t(heap) + page - 1) / page * page;
    madvise(reinterpret_cast<void*>(begin), size - page, MADV_HUGEPAGE);
    std::free(heap);
  }
#endif
}

void
restartWithShortSpins(char** argv)
{
  if (std::getenv("GOMP_SPINCOUNT") || std::getenv("OMP_WAIT_POLICY"))
    return;
  std::error_code error; // with its own name, for ps and killall
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error && setenv("GOMP_SPINCOUNT", "1000", 1) == 0)
    execv(program.c_str(), argv); // returns on failure: threads spin then
}

} // namespace pcl_semantic::tool
