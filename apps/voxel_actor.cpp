// SPDX-License-Identifier: BSD-3-Clause
#include "vtk_parts.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkLODActor.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <cstring>

namespace pcl_semantic::tool {

namespace {

// Drawn while the camera moves, where all faces would take too long.
constexpr std::size_t kFewPoints = 60000;

// Places and their colours, and nothing that connects them yet.
struct Vertices {
  explicit Vertices(vtkIdType count)
  {
    places->SetNumberOfComponents(3);
    places->SetNumberOfTuples(count);
    colours->SetNumberOfComponents(3);
    colours->SetNumberOfTuples(count);
  }

  vtkSmartPointer<vtkPolyDataMapper>
  mapper(vtkPolyData& data) const
  {
    const auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetData(places);
    data.SetPoints(points);
    data.GetPointData()->SetScalars(colours);
    auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
    mapper->SetInputData(&data);
    return mapper;
  }

  vtkSmartPointer<vtkFloatArray> places = vtkSmartPointer<vtkFloatArray>::New();
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
    std::memcpy(vertices.places->GetPointer(12 * i), face.corners.data(),
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
    std::memcpy(vertices.places->GetPointer(3 * i), face.corners.data(),
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
