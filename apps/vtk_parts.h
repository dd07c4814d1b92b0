// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <pcl_semantic/pictures/scene_view.h>

#include <vtkSmartPointer.h>

class vtkActor;
class vtkActor2D;
class vtkCamera;
class vtkRenderWindow;

/** \brief Parts of a VTK scene, without lights: colours are drawn unchanged. */
namespace pcl_semantic::tool {

/** \brief The faces between visible voxels of a map and the rest, shaded by orientation
 * and in the corners between voxels, as in rendered images. An open upper face has
 * exactly its voxel's colour. While the camera moves, a subset of points is drawn
 * instead, because large maps have too many faces. */
vtkSmartPointer<vtkActor> actorOf(const ViewedMap& map, const ViewState& state);

/** \brief The path of a camera, in the red of rendered images. */
vtkSmartPointer<vtkActor> actorOf(const Trajectory& path);

/** \brief The outlines of a map's planes, with a white border. */
std::vector<vtkSmartPointer<vtkActor>> outlineActors(const ViewedMap& map);

/** \brief The visible boxes of objects in the colours of their classes, the selected
 * one in red, with white borders for contrast. */
std::vector<vtkSmartPointer<vtkActor>> boxActors(const ViewedMap& map,
                                                 const ViewState& state);

/** \brief An image at its camera's position, with rays from the camera to its
 * corners. */
std::vector<vtkSmartPointer<vtkActor>> actorsOf(const ViewedImage& picture);

/** \brief An image in the lower left corner of the window. */
vtkSmartPointer<vtkActor2D> flatActorOf(const cv::Mat& picture);

/** \brief Sets a camera to a view of a map; it rotates about the map's centre. */
void setCamera(vtkCamera& camera, const SceneView& view, const ViewedMap& map);

/** \brief Renders the window: CV_8UC3 (BGR). */
cv::Mat pictureOf(vtkRenderWindow& window);

} // namespace pcl_semantic::tool
