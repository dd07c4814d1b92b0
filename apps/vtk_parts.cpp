// SPDX-License-Identifier: BSD-3-Clause
#include "vtk_parts.h"

#include "picture_options.h"

#include <opencv2/imgproc.hpp>
#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkTexture.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic::tool {

namespace {

vtkSmartPointer<vtkActor>
unlitActor(vtkPolyData* data)
{
  const auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  return actor;
}

vtkSmartPointer<vtkActor>
lineActor(const std::vector<SensorPath>& lines, float width)
{
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (const SensorPath& line : lines) {
    cells->InsertNextCell(int(line.size()));
    for (const Eigen::Vector3d& point : line)
      cells->InsertCellPoint(points->InsertNextPoint(point.data()));
  }
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(cells);
  auto actor = unlitActor(data);
  actor->GetProperty()->SetColor(235 / 255.0, 60 / 255.0, 60 / 255.0);
  actor->GetProperty()->SetLineWidth(width);
  return actor;
}

// Rows go up, and red comes first.
vtkSmartPointer<vtkImageData>
imageOf(const cv::Mat& picture)
{
  const auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(picture.cols, picture.rows, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  cv::Mat rgb(picture.size(), CV_8UC3, image->GetScalarPointer());
  cv::flip(picture, rgb, 0);
  cv::cvtColor(rgb, rgb, cv::COLOR_BGR2RGB);
  return image;
}

} // namespace

vtkSmartPointer<vtkActor>
actorOf(const Trajectory& path)
{
  return lineActor({pathOf(path)}, 4.0f);
}

std::vector<vtkSmartPointer<vtkActor>>
actorsOf(const ViewedPicture& picture)
{
  constexpr double distance = 1.5; // [m]
  const StereoCamera& camera = picture.camera;
  const double right = camera.width - 0.5, bottom = camera.height - 0.5;
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto texture_places = vtkSmartPointer<vtkFloatArray>::New();
  texture_places->SetNumberOfComponents(2);
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->InsertNextCell(4);
  std::vector<SensorPath> rays;
  for (const auto& [u, v] : {std::pair(-0.5, bottom), std::pair(right, bottom),
                             std::pair(right, -0.5), std::pair(-0.5, -0.5)}) {
    const Eigen::Vector3d corner =
        picture.T_map_camera * camera.unproject(u, v, distance);
    cells->InsertCellPoint(points->InsertNextPoint(corner.data()));
    texture_places->InsertNextTuple2(u > 0.0 ? 1.0 : 0.0, v > 0.0 ? 0.0 : 1.0);
    rays.push_back({picture.T_map_camera.translation(), corner});
  }
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetPointData()->SetTCoords(texture_places);
  auto actor = unlitActor(data);
  const auto texture = vtkSmartPointer<vtkTexture>::New();
  texture->SetInputData(imageOf(picture.image));
  texture->InterpolateOn();
  actor->SetTexture(texture);
  return {actor, lineActor(rays, 1.5f)};
}

vtkSmartPointer<vtkActor2D>
flatActorOf(const cv::Mat& picture)
{
  const auto mapper = vtkSmartPointer<vtkImageMapper>::New();
  mapper->SetInputData(imageOf(picture));
  mapper->SetColorWindow(255.0); // as they are
  mapper->SetColorLevel(127.5);
  auto actor = vtkSmartPointer<vtkActor2D>::New();
  actor->SetMapper(mapper);
  return actor;
}

void
setCamera(vtkCamera& camera, const PictureView& view, const ViewedMap& map)
{
  Eigen::Vector3d middle = map.grid.corner;
  for (const VoxelIndex& index : map.indices)
    middle += index.cast<double>() * map.grid.size / double(map.indices.size());
  const Eigen::Matrix3d& axes = view.T_world_camera.linear();
  Eigen::Vector3d from = view.T_world_camera.translation() + map.grid.corner;
  const StereoCamera& lens = view.camera;
  camera.SetParallelProjection(view.pixels_per_metre > 0.0);
  if (view.pixels_per_metre > 0.0) {
    camera.SetParallelScale(0.5 * lens.height / view.pixels_per_metre);
    from.z() = middle.z() + 200.0; // instead of so far that rays are nearly parallel
  }
  const double distance = std::max(1.0, axes.col(2).dot(middle - from));
  const Eigen::Vector3d to = from + distance * axes.col(2), up = -axes.col(1);
  camera.SetPosition(from.data());
  camera.SetFocalPoint(to.data());
  camera.SetViewUp(up.data());
  camera.SetViewAngle(2.0 * std::atan(0.5 * lens.height / lens.fy) * 180.0 / M_PI);
  camera.SetWindowCenter(1.0 - (2.0 * lens.cx + 1.0) / lens.width,
                         (2.0 * lens.cy + 1.0) / lens.height - 1.0);
}

cv::Mat
pictureOf(vtkRenderWindow& window)
{
  const auto filter = vtkSmartPointer<vtkWindowToImageFilter>::New();
  filter->SetInput(&window);
  filter->SetInputBufferTypeToRGB();
  filter->ReadFrontBufferOff();
  filter->Update();
  vtkImageData& image = *filter->GetOutput();
  const cv::Mat rgb(image.GetDimensions()[1], image.GetDimensions()[0], CV_8UC3,
                    image.GetScalarPointer());
  cv::Mat picture;
  cv::cvtColor(rgb, picture, cv::COLOR_RGB2BGR);
  cv::flip(picture, picture, 0);
  return picture;
}

} // namespace pcl_semantic::tool
