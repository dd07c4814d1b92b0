// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"
#include "files/is_there.h"

#include <pcl_semantic/core/local_origin.h>
#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/core/printable.h>
#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>

#include <algorithm>
#include <filesystem>

#include <unistd.h>

namespace pcl_semantic::python {

namespace {

const pid_t loaded_by = ::getpid();

} // namespace

py::array
asNumbers(const py::handle& array)
{
  if (py::hasattr(array, "mask") && py::hasattr(array, "filled"))
    throw py::value_error("got a masked array, whose mask would be lost: give the "
                          "values that count, or filled() ones");
  py::array any = py::array::ensure(array);
  if (!any)
    return any;
  const char kind = any.dtype().kind();
  if (kind == 'c')
    throw py::value_error("got complex numbers, expected real ones");
  if (kind == 'M' || kind == 'm')
    throw py::value_error("got dates or times, expected numbers");
  return any;
}

py::array
numbersOf(const py::handle& array)
{
  const py::array any = asNumbers(array);
  if (!any)
    throw py::type_error("expected an array of numbers");
  return any;
}

bool
isForked()
{
  return ::getpid() != loaded_by;
}

void
warn(const std::string& message)
{
  if (PyErr_WarnEx(PyExc_UserWarning, printable(message).c_str(), 1) != 0)
    throw py::error_already_set();
}

void
requireShape(const py::array& array, const char* name, py::ssize_t rows,
             std::optional<py::ssize_t> columns)
{
  const auto fits = [&](int axis, py::ssize_t size) {
    return size == kAny || array.shape(axis) == size;
  };
  if (array.ndim() == (columns ? 2 : 1) && fits(0, rows) &&
      (!columns || fits(1, *columns)))
    return;
  const auto number = [](py::ssize_t n, const char* any) {
    return n == kAny ? std::string(any) : std::to_string(n);
  };
  std::string found;
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    found += (i ? " x " : "") + std::to_string(array.shape(i));
  badParameter(name, " are ", found.empty() ? "one number" : found, ", expected ",
               number(rows, "N"), columns ? " x " + number(*columns, "L") : "");
}

void
requireIntegers(const py::array& array, const char* name)
{
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u' && kind != 'b' && array.size() > 0)
    badParameter(name, " are ", py::str(array.dtype()).cast<std::string>(),
                 ", expected integers");
}

void
requireWithin(std::int64_t value, std::int64_t largest, const char* name)
{
  if (value < 0 || value > largest)
    badParameter(name, " hold ", value, ", expected 0 to ", largest);
}

void
requirePcdName(const std::string& path)
{
  if (std::filesystem::path(path).extension() != ".pcd")
    badParameter(path, ": expected a name that ends in .pcd");
}

void
setParameters(const ConfigParameters& parameters, const py::kwargs& values)
{
  for (const auto& [key, value] : values) {
    const auto name = key.cast<std::string>();
    const auto found =
        std::find_if(parameters.begin(), parameters.end(),
                     [&](const ConfigParameter& each) { return each.name == name; });
    if (found == parameters.end())
      throw py::type_error(whyRemoved(name).empty() ? "unknown parameter '" + name + "'"
                                                    : name + ": " + whyRemoved(name));
    std::string text;
    if (py::isinstance<py::bool_>(value))
      text = value.cast<bool>() ? "true" : "false";
    else if (py::isinstance<py::sequence>(value) && !py::isinstance<py::str>(value))
      for (const py::handle each : value)
        text += (text.empty() ? "" : ",") + py::str(each).cast<std::string>();
    else
      text = py::str(value).cast<std::string>();
    ConfigParameter(*found).set(text, name);
  }
}

LabelSet
labelSetOf(const std::string& path_or_name)
{
  if (isThere(path_or_name) || path_or_name.find_first_of("./") != std::string::npos)
    return readLabelSet(path_or_name);
  return readLabelSet(findDataFile("label_sets/" + path_or_name + ".yaml"));
}

Eigen::Isometry3d
poseOf(const Array<double>& pose)
{
  requireShape(pose, "numbers of the pose", 4, 4);
  const Eigen::Isometry3d T_world_sensor(Eigen::Matrix4d(
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(pose.data())));
  requireRigid(T_world_sensor, "the pose");
  return T_world_sensor;
}

pcl::PointCloud<pcl::PointXYZRGBL>::Ptr
cloudOf(const Array<float>& points, const MaybeArray<std::uint8_t>& colours)
{
  requireShape(points, "points", kAny, 3);
  if (colours)
    requireShape(*colours, "colours", points.shape(0), 3);
  const auto count = std::size_t(points.shape(0));
  const float* const xyz = points.data();
  const std::uint8_t* const rgb = colours ? colours->data() : nullptr;
  const pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud(
      new pcl::PointCloud<pcl::PointXYZRGBL>);
  cloud->resize(count);
  cloud->is_dense = false;
  for (std::size_t i = 0; i < count; ++i) {
    pcl::PointXYZRGBL& point = (*cloud)[i];
    point.getVector3fMap() << xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2];
    point.label = 0;
    if (rgb) {
      point.r = rgb[3 * i];
      point.g = rgb[3 * i + 1];
      point.b = rgb[3 * i + 2];
    }
  }
  return cloud;
}

void
warnOfSteps(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud,
            const Eigen::Vector3d& origin)
{
  if (const std::string doubt = doubtOfSteps(cloud, "points", origin); !doubt.empty())
    warn(doubt);
}

LocalCloud
localCloudOf(const py::object& points, const MaybeArray<std::uint8_t>& colours)
{
  const py::array any = numbersOf(points);
  LocalCloud local;
  if (any.dtype().kind() == 'f' && any.itemsize() <= 4) {
    local.cloud = cloudOf(Array<float>(any), colours);
    warnOfSteps(*local.cloud);
    return local;
  }
  const Array<double> wide(any);
  requireShape(wide, "points", kAny, 3);
  const Eigen::Map<const Eigen::Matrix3Xd> positions(wide.data(), 3, wide.shape(0));
  local.origin = localOrigin(positions);
  const bool is_single = areSingle(positions);
  Array<float> relative({wide.shape(0), py::ssize_t(3)});
  Eigen::Map<Eigen::Matrix3Xf>(relative.mutable_data(), 3, wide.shape(0)) =
      relativeTo(local.origin, positions);
  local.cloud = cloudOf(relative, colours);
  if (is_single)
    warnOfSteps(*local.cloud, local.origin);
  return local;
}

LabelDistributions
distributionsOf(const MaybeArray<float>& rows, py::ssize_t points)
{
  if (!rows)
    return {};
  requireShape(*rows, "probabilities", points, kAny);
  return LabelDistributions(
      LabelDistributions::Matrix(Eigen::Map<const LabelDistributions::Matrix>(
          rows->data(), rows->shape(1), points)));
}

py::array_t<float>
arrayOf(LabelDistributions distributions)
{
  auto* const matrix =
      new LabelDistributions::Matrix(std::move(distributions.matrix()));
  const py::capsule owner(
      matrix, [](void* p) { delete static_cast<LabelDistributions::Matrix*>(p); });
  return py::array_t<float>({matrix->cols(), matrix->rows()}, matrix->data(), owner);
}

py::array_t<std::uint8_t>
labelsOf(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  py::array_t<std::uint8_t> labels((py::ssize_t(cloud.size())));
  std::transform(cloud.begin(), cloud.end(), labels.mutable_data(),
                 [](const pcl::PointXYZRGBL& p) { return std::uint8_t(p.label); });
  return labels;
}

py::dict
dictOf(VoxelCloud voxels)
{
  const auto count = py::ssize_t(voxels.size());
  py::array_t<double> points({count, py::ssize_t(3)});
  py::array_t<std::uint8_t> colours({count, py::ssize_t(3)});
  py::array_t<std::int32_t> indices({count, py::ssize_t(3)});
  py::array_t<std::uint32_t> observations(count);
  double* xyz = points.mutable_data();
  std::uint8_t* rgb = colours.mutable_data();
  std::int32_t* index = indices.mutable_data();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const pcl::PointXYZRGBL& point = (*voxels.cloud)[i];
    for (int a = 0; a < 3; ++a)
      *xyz++ = double(point.data[a]) + voxels.origin[a];
    *rgb++ = point.r;
    *rgb++ = point.g;
    *rgb++ = point.b;
    for (int a = 0; a < 3; ++a)
      *index++ = voxels.indices[i][a];
  }
  std::copy(voxels.observations.begin(), voxels.observations.end(),
            observations.mutable_data());
  py::dict result;
  result["points"] = points;
  result["colours"] = colours;
  result["labels"] = labelsOf(*voxels.cloud);
  result["probabilities"] = arrayOf(std::move(voxels.refined));
  result["observations"] = observations;
  result["indices"] = indices;
  return result;
}

} // namespace pcl_semantic::python
