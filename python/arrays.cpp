// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"
#include "core/fail.h"
#include "core/label_number.h"
#include "core/probability_sums.h"
#include "core/text_stream.h"
#include "files/is_there.h"
#include "filters/unread_parameters.h"

#include <pcl_semantic/core/local_origin.h>
#include <pcl_semantic/core/position_steps.h>
#include <pcl_semantic/core/printable.h>
#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/files/config_file.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>

#include <algorithm>
#include <cmath>
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
    throw py::value_error("got a masked array, expected one without a mask; use "
                          "filled() or compressed()");
  py::array any = py::array::ensure(array);
  if (!any)
    return any;
  const char kind = any.dtype().kind();
  if (kind == 'c')
    throw py::value_error("got complex numbers, expected real ones");
  if (kind == 'M' || kind == 'm')
    throw py::value_error("got dates or times, expected numbers");
  if (kind == 'O') // numpy would make them NaN
    for (const py::handle each : any.attr("ravel")())
      if (each.is_none())
        throw py::value_error("got None, expected numbers");
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

std::string
shapeOf(const py::array& array)
{
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    text += (text.empty() ? "" : " x ") + std::to_string(array.shape(i));
  return text.empty() ? "one number" : text;
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
  if (array.ndim() == 1 && array.size() == 0 && rows <= 0)
    return;
  const auto number = [](py::ssize_t n, const char* any) {
    return n == kAny ? std::string(any) : std::to_string(n);
  };
  badParameter(name, " are ", shapeOf(array), ", expected ", number(rows, "N"),
               columns ? " x " + number(*columns, "L") : "");
}

void
requireIntegers(const py::array& array, const char* name)
{
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u' && kind != 'b' && array.size() > 0)
    badParameter(name, " are ", py::str(array.dtype()).cast<std::string>(),
                 ", expected integers");
}

Label
labelOf(std::int64_t number, const char* name, std::size_t point)
{
  const std::int64_t label = withoutInstance(number);
  if (label == number && (label < 0 || label > 255))
    badInput(name, ": ", number, " of point ", point, ", expected 0 to 255");
  if (label < 0 || label > 255)
    badInput(name, ": ", number, " of point ", point, " is class ", label,
             " of an instance, expected 0 to 255");
  return Label(label);
}

void
requirePcdName(const std::string& path)
{
  if (std::filesystem::path(path).extension() != ".pcd")
    badParameter(path, ": expected a name that ends in .pcd");
}

namespace {

// Formats a value as in a parameter file.
std::string
textOf(const py::handle& value)
{
  const bool is_list = py::isinstance<py::sequence>(value) &&
                       !py::isinstance<py::str>(value) &&
                       !(py::isinstance<py::array>(value) &&
                         py::reinterpret_borrow<py::array>(value).ndim() == 0);
  if (!is_list) {
    const auto text = py::str(value).cast<std::string>();
    return text == "True" ? "true" : text == "False" ? "false" : text;
  }
  std::string text;
  for (const py::handle each : value)
    text += (text.empty() ? "" : ",") + py::str(each).cast<std::string>();
  return text;
}

} // namespace

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
    ConfigParameter(*found).set(textOf(value), name);
  }
}

void
refuseUnread(const py::kwargs& given, const std::vector<std::string>& unread,
             const std::string& condition)
{
  for (const std::string& name : unread)
    if (given.contains(name))
      badParameter(name, " has no effect ", condition);
}

void
refuseUnreadOfCRF(const py::kwargs& given, const std::string& model,
                  const std::string& cliques)
{
  for (const UnreadParameters& rule : unreadParametersOfCRF(model, cliques))
    if (rule.holds)
      refuseUnread(given, rule.names, "with " + rule.because + "='" + rule.value + "'");
}

LabelSet
labelSetOf(const std::string& path_or_name)
{
  if (isThere(path_or_name) || path_or_name.find_first_of("./") != std::string::npos)
    return readLabelSet(path_or_name);
  return readLabelSet(findDataFile("label_sets/" + path_or_name + ".yaml"));
}

namespace {

// A floating-point type with its precision.
struct FloatType {
  const char* name;
  int digits; // binary digits after the first

  double
  stepAt(double distance) const
  {
    return std::ldexp(1.0, std::ilogb(distance) - digits);
  }
};

FloatType
floatTypeOf(const py::array& array)
{
  if (array.dtype().kind() == 'f' && array.itemsize() == 2)
    return {"half precision", 10};
  if (array.dtype().kind() == 'f' && array.itemsize() == 4)
    return {"single precision", 23};
  return {"double precision", 52};
}

// Median distance of the positions, by their largest coordinate; 0 if there are none.
// Columns that are not finite are ignored.
template <typename Positions>
double
middleDistance(const Positions& positions)
{
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    if (positions.col(i).allFinite())
      distances.push_back(double(positions.col(i).cwiseAbs().maxCoeff()));
  if (distances.empty())
    return 0.0;
  const auto middle = distances.begin() + std::ptrdiff_t(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void
warnOfSteps(const char* name, const FloatType& type, double distance,
            const std::string& size)
{
  TextStream text;
  text << name << ": " << type.name << " has steps of " << type.stepAt(distance)
       << " m at " << distance << " m, coarser than a tenth of " << size
       << ": positions are rounded; give doubles (float64)";
  warn(text.str());
}

} // namespace

void
warnOfSteps(const py::array& given, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
            double voxel_size, const char* name)
{
  const FloatType type = floatTypeOf(given);
  const double distance = middleDistance(positions);
  if (distance > 0.0 && type.digits < 52 && type.stepAt(distance) > 0.1 * voxel_size) {
    TextStream size;
    size << "a voxel, " << voxel_size << " m";
    warnOfSteps(name, type, distance, size.str());
  }
}

Eigen::Isometry3d
poseOf(const py::object& pose, double voxel_size)
{
  const py::array any = numbersOf(pose);
  const Array<double> numbers(any);
  requireShape(numbers, "numbers of the pose", 4, 4);
  Eigen::Isometry3d T_world_sensor(Eigen::Matrix4d(
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data())));
  requireRigid(T_world_sensor, "the pose");
  T_world_sensor.makeAffine(); // makes its last row exact
  warnOfSteps(any, T_world_sensor.translation(), voxel_size, "the pose");
  return T_world_sensor;
}

namespace {

void
requireColours(const MaybeArray<std::uint8_t>& colours, Eigen::Index points)
{
  if (colours)
    requireShape(*colours, "colours", points, 3);
}

pcl::PointCloud<pcl::PointXYZRGBL>::Ptr
cloudOf(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
        const MaybeArray<std::uint8_t>& colours)
{
  requireColours(colours, positions.cols());
  const auto count = std::size_t(positions.cols());
  const std::uint8_t* const rgb = colours ? colours->data() : nullptr;
  const pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud(
      new pcl::PointCloud<pcl::PointXYZRGBL>);
  cloud->resize(count);
  cloud->is_dense = false;
  for (std::size_t i = 0; i < count; ++i) {
    pcl::PointXYZRGBL& point = (*cloud)[i];
    point.getVector3fMap() = positions.col(Eigen::Index(i));
    point.label = 0;
    if (rgb) {
      point.r = rgb[3 * i];
      point.g = rgb[3 * i + 1];
      point.b = rgb[3 * i + 2];
    }
  }
  return cloud;
}

using SinglePositions = Eigen::Map<const Eigen::Matrix3Xf>;

SinglePositions
positionsOf(const Array<float>& points)
{
  requireShape(points, "points", kAny, 3);
  return {points.data(), 3, points.shape(0)};
}

// Checks half precision: calls doubtOfSteps() for the points at a distance where single
// precision has the same steps.
void
warnOfHalfSteps(const SinglePositions& positions, const FloatType& type)
{
  const double distance = middleDistance(positions);
  const Eigen::Matrix3Xf shifted = positions.array() + float(8191.0 * distance);
  if (!doubtOfSteps(shifted, Eigen::Vector3d::Zero(), "points").empty())
    warnOfSteps("points", type, distance, "the points' distances");
}

// Reports doubtOfSteps() with a hint for scans, whose input may be doubles.
void
warnOfScanSteps(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud)
{
  const std::string doubt = doubtOfSteps(cloud, "points");
  if (!doubt.empty())
    warn(doubt.substr(0, doubt.rfind("; ")) +
         "; scans are computed in single precision: give points in the frame of the "
         "sensor, and its pose");
}

// Positions relative to an origin, see localOrigin() [m].
struct LocalPositions {
  Eigen::Matrix3Xf positions;
  Eigen::Matrix3Xf remainders; // remaindersOf()
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();

  void
  warnOfSteps() const
  {
    const std::string doubt = doubtOfSteps(positions, origin, "points");
    if (!doubt.empty())
      warn(doubt);
  }
};

LocalPositions
localPositionsOf(const py::object& points)
{
  const py::array any = numbersOf(points);
  LocalPositions local;
  if (any.dtype().kind() == 'f' && any.itemsize() <= 4) {
    const Array<float> single(any);
    local.positions = positionsOf(single);
    if (const FloatType type = floatTypeOf(any); type.digits < 23)
      warnOfHalfSteps(positionsOf(single), type);
    else
      local.warnOfSteps();
    return local;
  }
  const Array<double> wide(any);
  requireShape(wide, "points", kAny, 3);
  const Eigen::Map<const Eigen::Matrix3Xd> positions(wide.data(), 3, wide.shape(0));
  local.origin = localOrigin(positions);
  local.positions = relativeTo(local.origin, positions);
  local.remainders = remaindersOf(local.origin, positions, local.positions);
  if (areSingle(positions))
    local.warnOfSteps();
  return local;
}

} // namespace

pcl::PointCloud<pcl::PointXYZRGBL>::Ptr
scanOf(const py::object& points, const MaybeArray<std::uint8_t>& colours)
{
  const py::array any = numbersOf(points);
  const Array<float> single(any);
  const auto cloud = cloudOf(positionsOf(single), colours);
  const FloatType type = floatTypeOf(any);
  if (type.digits < 23)
    warnOfHalfSteps(positionsOf(single), type);
  else
    warnOfScanSteps(*cloud);
  return cloud;
}

LocalCloud
localCloudOf(const py::object& points, const MaybeArray<std::uint8_t>& colours)
{
  const LocalPositions local = localPositionsOf(points);
  return {cloudOf(local.positions, colours), local.origin};
}

CloudFields
cloudFieldsOf(const py::object& points, const MaybeArray<std::uint8_t>& colours)
{
  LocalPositions local = localPositionsOf(points);
  const Eigen::Index count = local.positions.cols();
  requireColours(colours, count);
  CloudFields fields;
  fields.positions = std::move(local.positions);
  fields.remainders = std::move(local.remainders);
  fields.origin = local.origin;
  if (colours)
    fields.colours = Eigen::Map<const Eigen::Matrix<std::uint8_t, 3, Eigen::Dynamic>>(
                         colours->data(), 3, count)
                         .cast<float>();
  fields.labels.assign(std::size_t(count), kUnlabelled);
  fields.width = std::uint32_t(count);
  fields.height = 1;
  return fields;
}

namespace {

// N x L row by row is L x N column by column.
template <typename T>
LabelDistributions
distributionsOfRows(const Array<T>& rows)
{
  const py::ssize_t points = rows.shape(0), classes = rows.shape(1);
  LabelDistributions::Matrix columns(classes, points);
  const T* value = rows.data();
  float* column = columns.data();
  for (py::ssize_t i = 0; i < points; ++i) {
    double sum = 0.0;
    for (py::ssize_t k = 0; k < classes; ++k, ++value) {
      if (!(*value >= T(0)))
        badInput("probabilities of point ", i, " hold ", *value,
                 ", expected 0 to 1 (of logits, give their softmax)");
      sum += double(*value);
      *column++ = float(*value);
    }
    if (!isSumOfProbabilities(sum))
      badInput("probabilities of point ", i, " sum to ", sum,
               ", expected 1 (of logits, give their softmax), or 0 = unlabelled");
  }
  return LabelDistributions(std::move(columns));
}

} // namespace

LabelDistributions
distributionsOf(const py::object& probabilities, py::ssize_t points)
{
  if (probabilities.is_none())
    return {};
  py::array any = numbersOf(probabilities);
  if (any.ndim() == 3 && any.shape(0) * any.shape(1) == points) // of an image
    any = any.reshape({points, any.shape(2)});
  requireShape(any, "probabilities", points, kAny);
  if (any.ndim() == 1 || (points == 0 && any.shape(1) == 0))
    return {};
  return any.dtype().kind() == 'f' && any.itemsize() <= 4
             ? distributionsOfRows(Array<float>(any))
             : distributionsOfRows(Array<double>(any));
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
  if (!voxels.objects.empty())
    result["objects"] = py::array_t<std::uint32_t>(py::ssize_t(voxels.objects.size()),
                                                   voxels.objects.data());
  return result;
}

} // namespace pcl_semantic::python
