// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/visualization/pcl_visualizer.h>

#include <vtkObjectFactory.h>
#include <vtkRenderWindowInteractor.h>

#include <functional>
#include <string>

namespace pcl_semantic::tool {

/** \brief PCL's mouse, our keys: PCL's own would print, write files and change clouds.
 */
class KeyStyle : public pcl::visualization::PCLVisualizerInteractorStyle {
public:
  /** \brief Made as VTK makes its objects. */
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

  // PCL's draws again at every tick, which takes a whole processor without a graphics
  // card; what changes the picture draws it.
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

} // namespace pcl_semantic::tool
