// SPDX-License-Identifier: BSD-3-Clause
#include "display.h"
#include "core/fail.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <X11/Xlib.h>
#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

// Set for the restarted program, which must not restart again.
constexpr const char* kStartedAgain = "PCL_SEMANTIC_ON_VIRTUAL_DISPLAY";

bool
isProgram(const std::string& name)
{
  const char* const folders = std::getenv("PATH");
  std::istringstream stream(folders ? folders : "");
  for (std::string folder; std::getline(stream, folder, ':');)
    if (access((folder + "/" + name).c_str(), X_OK) == 0)
      return true;
  return false;
}

} // namespace

bool
hasDisplay()
{
  // Stays open: a virtual server resets when its last client leaves, and refuses
  // clients during a reset.
  static Display* const display = XOpenDisplay(nullptr);
  int code = 0, event = 0, error = 0;
  return display && XQueryExtension(display, "GLX", &code, &event, &error);
}

void
restartOnVirtualDisplay(char** argv)
{
  for (const char* const program : {"xvfb-run", "xauth", "Xvfb"})
    if (std::getenv(kStartedAgain) || !isProgram(program))
      badParameter(
          "--screenshot without a display (DISPLAY) draws under xvfb-run, which ",
          std::getenv(kStartedAgain) ? "has none with OpenGL"
                                     : "is missing: packages xvfb and xauth");
  setenv(kStartedAgain, "1", 1);
  std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  // A server that resets when its last client leaves also signals xvfb-run, which then
  // fails occasionally.
  std::string words[] = {"xvfb-run", "--auto-servernum",
                         "--server-args=-screen 0 1280x1024x24 -nolisten tcp -noreset"};
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(self.data());
  for (char** word = argv + 1; *word; ++word)
    arguments.push_back(*word);
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  badParameter("xvfb-run cannot be started");
}

} // namespace pcl_semantic::tool
