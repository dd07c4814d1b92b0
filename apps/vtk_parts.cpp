// SPDX-License-Identifier: BSD-3-Clause
#include "vtk_parts.h"
#include "render_options.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkLODActor.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkTexture.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

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
actorsOf(const ViewedImage& picture)
{
  constexpr double distance = 1.5; // [m]
  const StereoCamera& camera = picture.camera;
  const double right = camera.width - 0.5, bottom = camera.height - 0.5;
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto texture_positions = vtkSmartPointer<vtkFloatArray>::New();
  texture_positions->SetNumberOfComponents(2);
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->InsertNextCell(4);
  std::vector<SensorPath> rays;
  for (const auto& [u, v] : {std::pair(-0.5, bottom), std::pair(right, bottom),
                             std::pair(right, -0.5), std::pair(-0.5, -0.5)}) {
    const Eigen::Vector3d corner =
        picture.T_map_camera * camera.unproject(u, v, distance);
    cells->InsertCellPoint(points->InsertNextPoint(corner.data()));
    texture_positions->InsertNextTuple2(u > 0.0 ? 1.0 : 0.0, v > 0.0 ? 0.0 : 1.0);
    rays.push_back({picture.T_map_camera.translation(), corner});
  }
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetPointData()->SetTCoords(texture_positions);
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
setCamera(vtkCamera& camera, const SceneView& view, const ViewedMap& map)
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

namespace {

// Drawn while the camera moves, where all faces would take too long.
constexpr std::size_t kFewPoints = 60000;

// Positions and their colours, and nothing that connects them yet.
struct Vertices {
  explicit Vertices(vtkIdType count)
  {
    positions->SetNumberOfComponents(3);
    positions->SetNumberOfTuples(count);
    colours->SetNumberOfComponents(3);
    colours->SetNumberOfTuples(count);
  }

  vtkSmartPointer<vtkPolyDataMapper>
  mapper(vtkPolyData& data) const
  {
    const auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetData(positions);
    data.SetPoints(points);
    data.GetPointData()->SetScalars(colours);
    auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
    mapper->SetInputData(&data);
    return mapper;
  }

  vtkSmartPointer<vtkFloatArray> positions = vtkSmartPointer<vtkFloatArray>::New();
  vtkSmartPointer<vtkUnsignedCharArray> colours =
      vtkSmartPointer<vtkUnsignedCharArray>::New();
};

vtkSmartPointer<vtkPolyDataMapper>
mapperOfAll(const std::vector<VoxelFace>& faces)
{
  const auto count = vtkIdType(faces.size());
  const Vertices vertices(4 * count);
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->Use32BitStorage();
  cells->AllocateExact(count, 4 * count);
  for (vtkIdType i = 0; i < count; ++i) {
    const VoxelFace& face = faces[std::size_t(i)];
    std::memcpy(vertices.positions->GetPointer(12 * i), face.corners.data(),
                sizeof face.corners);
    std::memcpy(vertices.colours->GetPointer(12 * i), face.colours.data(),
                sizeof face.colours);
    cells->InsertNextCell({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
  }
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPolys(cells);
  return vertices.mapper(*data);
}

// A corner of some faces, evenly over the map.
vtkSmartPointer<vtkPolyDataMapper>
mapperOfFew(const std::vector<VoxelFace>& faces)
{
  const std::size_t step = faces.size() / kFewPoints + 1;
  const auto count = vtkIdType((faces.size() + step - 1) / step);
  const Vertices vertices(count);
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (vtkIdType i = 0; i < count; ++i) {
    const VoxelFace& face = faces[std::size_t(i) * step];
    std::memcpy(vertices.positions->GetPointer(3 * i), face.corners.data(),
                sizeof face.corners[0]);
    std::memcpy(vertices.colours->GetPointer(3 * i), face.colours.data(),
                sizeof face.colours[0]);
    cells->InsertNextCell({i});
  }
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetVerts(cells);
  return vertices.mapper(*data);
}

} // namespace

vtkSmartPointer<vtkActor>
actorOf(const std::vector<VoxelFace>& faces)
{
  const auto actor = vtkSmartPointer<vtkLODActor>::New();
  actor->SetMapper(mapperOfAll(faces));
  actor->AddLODMapper(mapperOfFew(faces));
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->BackfaceCullingOn();
  actor->GetProperty()->SetPointSize(3.0f);
  return actor;
}

} // namespace pcl_semantic::tool
