// SPDX-License-Identifier: BSD-3-Clause
#include "live_view.h"

#include "live_frames.h"
#include "messages.h"

#include <pcl_semantic/core/exceptions.h>

#include <filesystem>

#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

constexpr int kPictureColumns = 640;

// Starts the viewer with a socket in the place of all its streams.
void
startViewer(const std::string& program, int socket)
{
  std::string words[] = {program, "--live"};
  char* const arguments[] = {words[0].data(), words[1].data(), nullptr};
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_adddup2(&streams, socket, stream);
  pid_t process = 0;
  const int error =
      posix_spawn(&process, program.c_str(), &streams, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&streams);
  if (error != 0)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--view: " << program
                                   << " cannot be started; is pcl_semantic_view "
                                      "installed?");
}

// What the viewer says first: "ready", or why it is not.
std::string
firstLine(int socket)
{
  std::string line;
  for (char c = 0; read(socket, &c, 1) == 1 && c != '\n';)
    line += c;
  return line;
}

} // namespace

LiveView::LiveView(const MappingRun& run)
    : camera_(run.camera.value_or(StereoCamera())), label_set_(run.label_set)
{
  if (!run.camera) // camera 0 stands in
    T_sensor_camera_ = run.T_camera0_camera.inverse();
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    PCL_THROW_EXCEPTION(InvalidParameterException, "--view: there is no socket left");
  socket_ = ends[0];
  try {
    startViewer((folder / "pcl_semantic_view").string(), ends[1]);
  }
  catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);
  const std::string line = firstLine(socket_);
  if (line != "ready") {
    close(socket_);
    PCL_THROW_EXCEPTION(
        InvalidParameterException,
        "--view: " << (line.empty() ? "the window did not open" : line));
  }
}

LiveView::~LiveView()
{
  if (socket_ >= 0)
    close(socket_);
}

void
LiveView::show(const MappedFrame& mapped)
{
  path_.push_back(mapped.T_world_camera * T_sensor_camera_);
  if (socket_ < 0)
    return;
  VoxelScene scene;
  scene.has_colour = scene.has_labels = true;
  scene.voxels = mapped.voxels;
  scene.origin = mapped.voxels.origin;
  scene.grid = {mapped.voxels.voxel_size, -scene.origin};
  ViewedMap map =
      viewedMap(scene, label_set_, "frame " + std::to_string(mapped.frame.number));
  map.path = path_;
  if (!mapped.frame.left.empty()) {
    map.pictures = {smallPicture(mapped.frame.left, camera_, mapped.T_world_camera,
                                 kPictureColumns)};
    map.pictures[0].T_map_camera.translation() -= scene.origin;
  }
  for (Eigen::Isometry3d& pose : map.path)
    pose.translation() -= scene.origin;
  send(map);
}

void
LiveView::finish(const SemanticVoxelMap& map)
{
  if (socket_ < 0)
    return;
  const VoxelScene scene = sceneOf(map);
  ViewedMap viewed = viewedMap(scene, label_set_, "the finished map");
  viewed.path = path_;
  for (Eigen::Isometry3d& pose : viewed.path)
    pose.translation() -= scene.origin;
  send(viewed);
}

void
LiveView::send(const ViewedMap& map)
{
  const std::string bytes = bytesOf(map);
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent,
                                 MSG_NOSIGNAL); // who closed the window maps on
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0) {
      note("the window was closed");
      close(socket_);
      socket_ = -1;
      return;
    }
    sent += std::size_t(count);
  }
}

} // namespace pcl_semantic::tool
