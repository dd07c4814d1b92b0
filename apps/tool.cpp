// SPDX-License-Identifier: BSD-3-Clause
#include "tool.h"
#include "manual_page.h"
#include "messages.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/version.h>

#include <opencv2/core.hpp>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>
#include <set>

namespace pcl_semantic::tool {

namespace {

volatile std::sig_atomic_t interrupt_count = 0;

extern "C" void
onInterrupt(int)
{
  interrupt_count = interrupt_count + 1;
  if (interrupt_count > 1)
    _exit(exit_interrupted);
}

int
fail(const std::string& name, const std::string& message, ExitCode code)
{
  std::cerr << name << ": " << printable(message) << std::endl;
  return code;
}

} // namespace

bool
parseCommandLine(int argc, char** argv, const Usage& usage,
                 const po::options_description& options,
                 const po::positional_options_description& positional,
                 po::variables_map& values)
{
  po::options_description general("General");
  Manner& how = manner();
  how.name = usage.name;
  general.add_options()("help,h", "print this help")("version", "print the version")(
      "quiet,q", po::bool_switch(&how.quiet),
      "print only errors, warnings and results")(
      "verbose,v", po::bool_switch(&how.verbose),
      "print each step with the time since the start")(
      "json", po::bool_switch(&how.json),
      "print results as JSON")("man", "print this help as a manual page");
  po::options_description all;
  all.add(options).add(general);
  try {
    // No guessing: an abbreviated option would change its meaning when one is added.
    using namespace po::command_line_style;
    po::store(po::command_line_parser(argc, argv)
                  .options(all)
                  .positional(positional)
                  .style(unix_style & ~allow_guessing)
                  .run(),
              values);
    if (values.count("help")) {
      std::cout << "Usage: " << usage.name << " " << usage.synopsis << "\n\n"
                << usage.description << "\n\nExample:\n  " << usage.example << "\n"
                << all;
      return false;
    }
    if (values.count("man")) {
      std::cout << manualPage(usage, all);
      return false;
    }
    if (values.count("version")) {
      std::cout << usage.name << " " << PCL_SEMANTIC_VERSION << "\n";
      return false;
    }
    po::notify(values);
    if (how.quiet && how.verbose)
      failUsage(usage, "--quiet and --verbose exclude each other");
  }
  catch (const po::too_many_positional_options_error&) {
    failUsage(usage, "too many positional arguments; a pattern of file names has to be "
                     "in quotes: --left 'left/*.png'");
  }
  catch (const po::error& error) {
    failUsage(usage, error.what());
  }
  return true;
}

void
failUsage(const Usage& usage, const std::string& message)
{
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      message << " (see " << usage.name << " --help)");
}

int
run(const std::string& name, const std::function<int()>& body)
{
  // OpenCV and PCL would otherwise print their own lines beside ours.
  cv::redirectError(
      [](int, const char*, const char*, const char*, int, void*) { return 0; });
  // What cannot be written is an error with a word, not the end of the process.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const int code = body();
    if (!std::cout.flush())
      return fail(name, "standard output cannot be written", exit_output_failed);
    return code;
  }
  catch (const InvalidParameterException& error) {
    return fail(name, error.what(), exit_usage);
  }
  catch (const BadModelException& error) {
    return fail(name, error.what(), exit_bad_model);
  }
  catch (const OutputException& error) {
    return fail(name, error.what(), exit_output_failed);
  }
  catch (const std::bad_alloc&) {
    return fail(name, "out of memory", exit_out_of_memory);
  }
  catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem)
      return fail(name, "out of memory", exit_out_of_memory);
    return fail(name, error.err, exit_bad_input);
  }
  catch (const std::exception& error) {
    return fail(name, error.what(), exit_bad_input);
  }
}

void
requireOutput(const std::string& path, const std::string& extension)
{
  if (path.empty())
    return;
  if (std::filesystem::path(path).extension() != extension)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        path << ": expected a name that ends in " << extension);
  const auto folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!folder.empty() && !std::filesystem::is_directory(folder, error))
    PCL_THROW_EXCEPTION(OutputException,
                        path << ": cannot be written: there is no folder " << folder);
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
         ", which stay: of an earlier run?");
}

void
refuseSameFiles(const std::vector<std::string>& inputs,
                const std::vector<std::string>& outputs)
{
  const auto isSame = [](const std::string& a, const std::string& b) {
    namespace fs = std::filesystem;
    std::error_code error;
    return !a.empty() && !b.empty() &&
           (fs::absolute(a, error).lexically_normal() ==
                fs::absolute(b, error).lexically_normal() ||
            fs::equivalent(a, b, error));
  };
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    std::vector<std::string> others = inputs;
    others.insert(others.end(), outputs.begin() + long(i) + 1, outputs.end());
    for (const std::string& other : others)
      if (isSame(outputs[i], other))
        PCL_THROW_EXCEPTION(InvalidParameterException,
                            outputs[i] << ": is named as an output and once more");
  }
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

} // namespace pcl_semantic::tool
