// SPDX-License-Identifier: BSD-3-Clause
#include "vtk_parts.h"
#include "render_options.h"

#include <pcl_semantic/map/voxel_set.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

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

// A visible face of a cube: its corners, counterclockwise from outside, and their
// colours.
struct VoxelFace {
  std::array<std::array<float, 3>, 4> corners;        // in the frame of the points [m]
  std::array<std::array<std::uint8_t, 3>, 4> colours; // red, green, blue
};

// Brightness of a face by axis and side: below, above, and the sides.
constexpr double kLight[3][2] = {{0.86, 0.72}, {0.70, 0.79}, {0.55, 1.0}};
constexpr double kCornerShade = 0.09;

class FaceMaker {
public:
  FaceMaker(const ViewedMap& map, const ViewState& state, const VoxelSet& set)
      : map_(map), colours_(map.colourings[state.colouring].colours), reader_(set)
  {}

  void
  add(std::size_t voxel, std::vector<VoxelFace>& faces)
  {
    const VoxelIndex& index = map_.indices[voxel];
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        VoxelIndex front = index;
        front[axis] += side == 0 ? -1 : 1;
        if (!reader_.contains(front))
          faces.push_back(face(voxel, front, axis, side));
      }
  }

private:
  VoxelFace
  face(std::size_t voxel, const VoxelIndex& front, int axis, int side)
  {
    // Order around the face, counterclockwise for the upper side.
    constexpr int round[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const cv::Vec3b& colour = colours_.colours[voxel];
    VoxelFace face;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& [to_b, to_c] = round[side == 1 ? k : 3 - k];
      VoxelIndex corner = map_.indices[voxel];
      corner[axis] += side;
      corner[b] += to_b;
      corner[c] += to_c;
      const double light = kLight[axis][side] * openness(front, b, c, to_b, to_c);
      const double shade = 1.0 - colours_.shading * (1.0 - light);
      for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        face.corners[k][at] =
            static_cast<float>(map_.grid.corner[i] + corner[i] * map_.grid.size);
        face.colours[k][at] =
            static_cast<std::uint8_t>(std::lround(colour[2 - i] * shade));
      }
    }
    return face;
  }

  // Voxels beside the cell in front of a face darken its corner.
  double
  openness(const VoxelIndex& front, int b, int c, int to_b, int to_c)
  {
    VoxelIndex beside_b = front, beside_c = front;
    beside_b[b] += to_b == 1 ? 1 : -1;
    beside_c[c] += to_c == 1 ? 1 : -1;
    VoxelIndex across = beside_b;
    across[c] = beside_c[c];
    const bool has_b = reader_.contains(beside_b), has_c = reader_.contains(beside_c);
    const int closed = has_b && has_c ? 3 : has_b + has_c + reader_.contains(across);
    return 1.0 - kCornerShade * closed;
  }

  const ViewedMap& map_;
  const VoxelColours& colours_;
  VoxelSet::Reader reader_;
};

// The faces between visible voxels of a map and the rest.
std::vector<VoxelFace>
facesOf(const ViewedMap& map, const ViewState& state)
{
  std::vector<std::size_t> shown;
  std::vector<VoxelIndex> indices;
  for (std::size_t i = 0; i < map.indices.size(); ++i)
    if (state.shows(map, i)) {
      shown.push_back(i);
      indices.push_back(map.indices[i]);
    }
  const VoxelSet set(indices);
  FaceMaker maker(map, state, set);
  std::vector<VoxelFace> faces;
  faces.reserve(2 * shown.size());
  for (const std::size_t voxel : shown)
    maker.add(voxel, faces);
  return faces;
}

// Drawn while the camera moves, because large maps have too many faces.
constexpr std::size_t kFewPoints = 60000;

// Draws squares by the four corners of each face, or one corner of every step-th face
// as a point.
template <int corners>
vtkSmartPointer<vtkPolyDataMapper>
mapperOf(const std::vector<VoxelFace>& faces, std::size_t step)
{
  const auto count = vtkIdType((faces.size() + step - 1) / step);
  const auto positions = vtkSmartPointer<vtkFloatArray>::New();
  const auto colours = vtkSmartPointer<vtkUnsignedCharArray>::New();
  for (vtkDataArray* const array :
       {static_cast<vtkDataArray*>(positions), static_cast<vtkDataArray*>(colours)}) {
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(corners * count);
  }
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->Use32BitStorage();
  cells->AllocateExact(count, corners * count);
  for (vtkIdType i = 0; i < count; ++i) {
    const VoxelFace& face = faces[std::size_t(i) * step];
    std::memcpy(positions->GetPointer(3 * corners * i), face.corners.data(),
                corners * sizeof face.corners[0]);
    std::memcpy(colours->GetPointer(3 * corners * i), face.colours.data(),
                corners * sizeof face.colours[0]);
    cells->InsertNextCell(corners);
    for (int corner = 0; corner < corners; ++corner)
      cells->InsertCellPoint(corners * i + corner);
  }
  const auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(positions);
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->GetPointData()->SetScalars(colours);
  if (corners == 1)
    data->SetVerts(cells);
  else
    data->SetPolys(cells);
  auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
  mapper->SetInputData(data);
  return mapper;
}

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

// The red of rendered images.
const cv::Vec3b path_colour(60, 60, 235);

vtkSmartPointer<vtkActor>
lineActor(const std::vector<SensorPath>& lines, float width,
          const cv::Vec3b& colour = path_colour)
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
  actor->GetProperty()->SetColor(colour[2] / 255.0, colour[1] / 255.0,
                                 colour[0] / 255.0);
  actor->GetProperty()->SetLineWidth(width);
  return actor;
}

// VTK's rows go up, and red is first.
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
actorOf(const ViewedMap& map, const ViewState& state)
{
  const std::vector<VoxelFace> faces = facesOf(map, state);
  const auto actor = vtkSmartPointer<vtkLODActor>::New();
  actor->SetMapper(mapperOf<4>(faces, 1));
  actor->AddLODMapper(mapperOf<1>(faces, faces.size() / kFewPoints + 1));
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->BackfaceCullingOn();
  actor->GetProperty()->SetPointSize(3.0f);
  return actor;
}

vtkSmartPointer<vtkActor>
actorOf(const Trajectory& path)
{
  return lineActor({pathOf(path)}, 4.0f);
}

std::vector<vtkSmartPointer<vtkActor>>
outlineActors(const ViewedMap& map)
{
  std::map<std::tuple<int, int, int>, std::vector<SensorPath>> by_colour;
  for (const auto& [from, to, colour] : map.outlines)
    by_colour[{colour[0], colour[1], colour[2]}].push_back({from, to});
  std::vector<vtkSmartPointer<vtkActor>> actors;
  for (const auto& [colour, lines] : by_colour) {
    const auto [blue, green, red] = colour;
    actors.push_back(lineActor(lines, 5.0f, cv::Vec3b(255, 255, 255)));
    actors.push_back(lineActor(
        lines, 2.0f,
        cv::Vec3b(std::uint8_t(blue), std::uint8_t(green), std::uint8_t(red))));
  }
  return actors;
}

std::vector<vtkSmartPointer<vtkActor>>
boxActors(const ViewedMap& map, const ViewState& state)
{
  std::vector<vtkSmartPointer<vtkActor>> actors;
  for (const bool is_border : {true, false})
    for (std::size_t i = 0; i < map.objects.size(); ++i) {
      const ViewedObject& object = map.objects[i];
      if (!state.shows(object))
        continue;
      std::vector<SensorPath> lines;
      const std::vector<Eigen::Vector3d> corners = object.box.corners();
      for (const auto& [from, to] : YawBox::edges)
        lines.push_back({corners[from], corners[to]});
      actors.push_back(lineActor(lines, is_border ? 5.0f : 2.0f,
                                 is_border             ? cv::Vec3b(255, 255, 255)
                                 : state.selected == i ? path_colour
                                                       : object.colour));
    }
  return actors;
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
  mapper->SetColorWindow(255.0); // unscaled
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
    from.z() = middle.z() + 200.0; // near: far rays are almost parallel
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
