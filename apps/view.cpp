// SPDX-License-Identifier: BSD-3-Clause
#include "display.h"
#include "map_viewer.h"
#include "messages.h"
#include "view_arguments.h"
#include "view_of_map.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/files/image_file.h>

#include <csignal>
#include <iostream>

#ifdef __SANITIZE_ADDRESS__
// What draws without a graphics card never frees 112 bytes. It is no longer loaded when
// they are counted, so they cannot be passed over by name.
extern "C" const char*
__asan_default_options()
{
  return "detect_leaks=0";
}
#endif

namespace {

using namespace pcl_semantic;

using tool::MapViewer;
using tool::ViewArguments;

int
leave(const ViewArguments& arguments, MapViewer& viewer)
{
  if (arguments.screenshot.empty())
    return tool::interrupted() ? tool::exit_interrupted : tool::exit_done;
  (arguments.small ? writeSmallPng : writePng)(arguments.screenshot, viewer.picture());
  tool::printResults({{"picture", arguments.screenshot}});
  return tool::exit_done;
}

int
viewMap(const ViewArguments& arguments)
{
  tool::OpenedMap opened = tool::openMap(arguments);
  MapViewer viewer("pcl_semantic_view: " + arguments.map, arguments.picture.size,
                   !arguments.screenshot.empty());
  viewer.state() = opened.state;
  viewer.show(std::move(opened.map), std::move(opened.views));
  for (const std::string& key : arguments.keys)
    viewer.press(key);
  if (arguments.screenshot.empty())
    viewer.run([] {});
  return leave(arguments, viewer);
}

int
followMap(const ViewArguments& arguments)
{
  MapViewer viewer("pcl_semantic_view: " + arguments.map, arguments.picture.size,
                   false);
  tool::FollowedMap map(arguments, viewer);
  std::cout << "following: " << arguments.map << std::endl;
  std::signal(SIGPIPE, SIG_IGN); // who started the window may end before it
  viewer.run([&] { map.update(); });
  return leave(arguments, viewer);
}

int
view(const ViewArguments& arguments, char** argv)
{
  setNumberOfThreads(arguments.threads);
  if (!tool::hasDisplay()) {
    if (arguments.screenshot.empty())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "there is no display with OpenGL to open a window on "
                          "(DISPLAY); pcl_semantic_view MAP --screenshot OUT.png "
                          "needs none");
    tool::restartOnVirtualDisplay(argv);
  }
  tool::catchInterrupts();
  return arguments.follow ? followMap(arguments) : viewMap(arguments);
}

} // namespace

int
main(int argc, char** argv)
{
  return tool::run("pcl_semantic_view", [&] {
    ViewArguments arguments;
    return tool::parseViewArguments(argc, argv, arguments) ? view(arguments, argv)
                                                           : int(tool::exit_done);
  });
}
