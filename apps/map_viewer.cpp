// SPDX-License-Identifier: BSD-3-Clause
#include "map_viewer.h"

#include "tool.h"
#include "view_panel.h"
#include "vtk_parts.h"

#include <pcl/visualization/pcl_visualizer.h>

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkObjectFactory.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

namespace pcl_semantic::tool {

namespace {

// PCL's mouse with other keys: PCL's keys would print, write files and change clouds.
class KeyStyle : public pcl::visualization::PCLVisualizerInteractorStyle {
public:
  // VTK's way to create objects.
  static KeyStyle*
  New()
  {
    VTK_STANDARD_NEW_BODY(KeyStyle);
  }

  vtkTypeMacro(KeyStyle, pcl::visualization::PCLVisualizerInteractorStyle)

      std::function<void(const std::string&)> on_key = [](const std::string&) {};
  std::function<bool(int, int)> on_click = [](int, int) { return false; };

protected:
  void
  OnChar() override
  {}

  void
  OnKeyDown() override
  {
    if (const char* const key = Interactor->GetKeySym())
      on_key(key);
  }

  void
  OnKeyUp() override
  {}

  // PCL redraws at every tick, which uses a whole processor without a graphics card.
  // Changes of the image redraw it explicitly.
  void
  OnTimer() override
  {}

  void
  OnLeftButtonDown() override
  {
    const int* const position = Interactor->GetEventPosition();
    if (!on_click(position[0], position[1]))
      Superclass::OnLeftButtonDown();
  }
};

} // namespace

struct MapViewer::Inside {
  Inside(const std::string& title, cv::Size size, bool off_screen)
  {
    vtkObject::GlobalWarningDisplayOff();
    pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
    window->SetOffScreenRendering(off_screen);
    int no_arguments = 0; // PCL must not parse the program's arguments
    char* none[] = {nullptr};
    visualizer = std::make_unique<pcl::visualization::PCLVisualizer>(
        no_arguments, none, renderer, window, title, style, !off_screen);
    visualizer->setShowFPS(false);
    visualizer->setSize(size.width, size.height);
    visualizer->setBackgroundColor(0.96, 0.97, 0.98);
    style->on_key = [this](const std::string& key) { press(key); };
    style->on_click = [this](int x, int y) { return click(x, y); };
  }

  ~Inside()
  {
    visualizer.reset();
    window->SetInteractor(nullptr); // breaks a reference cycle
  }

  void
  redraw(Redraw what)
  {
    if (what == Redraw::nothing)
      return;
    if (what == Redraw::camera)
      look();
    if (what == Redraw::voxels)
      drawVoxels();
    drawRest();
    if (window->GetInteractor())
      window->Render();
  }

  void
  press(const std::string& key)
  {
    redraw(tool::press(key, map, int(views.size()), state));
  }

  bool
  click(int x, int y)
  {
    if (!state.panel || x >= panel.picture.cols || y >= panel.picture.rows) {
      select(x, y);
      return false; // the mouse also turns the map
    }
    const int v = panel.picture.rows - 1 - y;
    for (const ViewPanel::Row& row : panel.rows)
      if (v >= row.top && v < row.bottom)
        toggle(row.label, state);
    redraw(Redraw::voxels);
    return true;
  }

  // Selects the object at a pixel.
  void
  select(int x, int y)
  {
    Eigen::Vector3d ends[2];
    for (const int end : {0, 1}) { // in front and behind
      double world[4];
      renderer->SetDisplayPoint(x, y, end);
      renderer->DisplayToWorld();
      renderer->GetWorldPoint(world);
      ends[end] = Eigen::Vector3d(world) / world[3];
    }
    const auto found = objectAt(map, state, ends[0], ends[1]);
    if (found == state.selected)
      return;
    state.selected = found;
    redraw(Redraw::panel);
  }

  void
  look()
  {
    setCamera(*renderer->GetActiveCamera(), views.at(std::size_t(state.view)), map);
    renderer->ResetCameraClippingRange();
  }

  void
  drawVoxels()
  {
    if (voxels)
      renderer->RemoveActor(voxels);
    voxels = actorOf(map, state);
    renderer->AddActor(voxels);
  }

  void
  drawRest()
  {
    for (const auto& actor : others)
      renderer->RemoveViewProp(actor);
    others.clear();
    if (state.path && map.path.size() > 1)
      others.push_back(actorOf(map.path));
    for (const auto& actor : boxActors(map, state))
      others.push_back(actor);
    if (state.boxes)
      for (const auto& actor : outlineActors(map))
        others.push_back(actor);
    if (state.pictures)
      for (const ViewedImage& picture : map.pictures)
        for (const auto& actor : actorsOf(picture))
          others.push_back(actor);
    if (state.panel) {
      panel = drawPanel(map, state, window->GetSize()[1]);
      others.push_back(flatActorOf(panel.picture));
    }
    for (const auto& actor : others)
      renderer->AddViewProp(actor);
    renderer->ResetCameraClippingRange();
  }

  vtkSmartPointer<vtkRenderer> renderer = vtkSmartPointer<vtkRenderer>::New();
  vtkSmartPointer<vtkRenderWindow> window = vtkSmartPointer<vtkRenderWindow>::New();
  vtkSmartPointer<KeyStyle> style = vtkSmartPointer<KeyStyle>::New();
  std::unique_ptr<pcl::visualization::PCLVisualizer> visualizer;
  ViewedMap map;
  std::vector<SceneView> views;
  ViewState state;
  ViewPanel panel;
  vtkSmartPointer<vtkActor> voxels;
  std::vector<vtkSmartPointer<vtkProp>> others;
  std::function<void()> tick;
};

MapViewer::MapViewer(const std::string& title, cv::Size size, bool off_screen)
    : inside_(std::make_unique<Inside>(title, size, off_screen))
{}

MapViewer::~MapViewer() = default;

void
MapViewer::show(ViewedMap map, std::vector<SceneView> views)
{
  const bool is_first = inside_->map.colourings.empty();
  inside_->map = std::move(map);
  inside_->views = std::move(views);
  ViewState& now = inside_->state;
  now.colouring %= inside_->map.colourings.size();
  now.selected.reset(); // another map has other objects
  if (is_first || std::size_t(now.view) >= inside_->views.size()) {
    now.view = 0;
    inside_->look();
  }
  inside_->redraw(Redraw::voxels);
}

void
MapViewer::move(const Eigen::Vector3d& step)
{
  vtkCamera& camera = *inside_->renderer->GetActiveCamera();
  const Eigen::Vector3d from = Eigen::Vector3d(camera.GetPosition()) + step;
  const Eigen::Vector3d to = Eigen::Vector3d(camera.GetFocalPoint()) + step;
  camera.SetPosition(from.data());
  camera.SetFocalPoint(to.data());
}

ViewState&
MapViewer::state()
{
  return inside_->state;
}

void
MapViewer::press(const std::string& key)
{
  inside_->press(key);
}

cv::Mat
MapViewer::picture()
{
  inside_->window->Render();
  return pictureOf(*inside_->window);
}

void
MapViewer::run(const std::function<void()>& tick)
{
  vtkRenderWindowInteractor& interactor = *inside_->window->GetInteractor();
  inside_->tick = [this, tick, &interactor] {
    tick();
    if (inside_->state.is_closed || interrupted())
      interactor.TerminateApp();
  };
  const auto command = vtkSmartPointer<vtkCallbackCommand>::New();
  command->SetClientData(inside_.get());
  command->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
    static_cast<Inside*>(data)->tick();
  });
  interactor.AddObserver(vtkCommand::TimerEvent, command);
  interactor.CreateRepeatingTimer(100);
  inside_->window->Render();
  interactor.Start();
}

} // namespace pcl_semantic::tool
