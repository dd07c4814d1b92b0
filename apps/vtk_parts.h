// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <pcl_semantic/pictures/scene_view.h>

#include <vtkSmartPointer.h>

class vtkActor;
class vtkActor2D;
class vtkCamera;
class vtkRenderWindow;

/** \brief Parts of a scene of VTK. Colours are as they are given: there is no light. */
namespace pcl_semantic::tool {

/** \brief The faces between what is shown of a map and the rest, shaded as the pictures
 * of maps are: by their orientation and in the corners between voxels. A face that
 * looks up and lies open has the very colour of its voxel. While the camera moves some
 * points are drawn instead, where all faces would take too long. */
vtkSmartPointer<vtkActor> actorOf(const ViewedMap& map, const ViewState& state);

/** \brief The path of a camera, in the red of the pictures. */
vtkSmartPointer<vtkActor> actorOf(const Trajectory& path);

/** \brief A picture in front of the place where it was taken, and the rays from there
 * to its corners. */
std::vector<vtkSmartPointer<vtkActor>> actorsOf(const ViewedImage& picture);

/** \brief A picture in the lower left corner of the window. */
vtkSmartPointer<vtkActor2D> flatActorOf(const cv::Mat& picture);

/** \brief Has a camera see as a view of a map does, and turn about its middle. */
void setCamera(vtkCamera& camera, const SceneView& view, const ViewedMap& map);

/** \brief Picture of the window: CV_8UC3 (BGR). */
cv::Mat pictureOf(vtkRenderWindow& window);

} // namespace pcl_semantic::tool
