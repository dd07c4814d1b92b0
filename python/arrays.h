// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <pcl_semantic/core/config_parameter.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/filters/cloud_crf.h>

#include <Eigen/Geometry>
#include <pcl/PointIndices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <future>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace pcl_semantic::python {

namespace py = pybind11;

/** \brief An array of this type, row by row, converted if necessary, else without a
 * copy. Complex numbers are refused because numpy would drop a part of them. */
template <typename T>
class Array : public py::array_t<T, py::array::c_style | py::array::forcecast> {
public:
  using py::array_t<T, py::array::c_style | py::array::forcecast>::array_t;
};

/** \brief A path: str, bytes or os.PathLike. A path with a NUL raises ValueError. */
struct Path {
  std::string text;

  operator const std::string&() const { return text; }
};

template <typename T> using MaybeArray = std::optional<Array<T>>;

constexpr py::ssize_t kAny = -1; ///< number of rows or columns

/** \brief Returns an array of real numbers. Refuses everything that numpy would drop:
 * the mask of numpy.ma, an imaginary part, the unit of a time, None.
 * \return null if it is no array
 * \throws value_error */
py::array asNumbers(const py::handle& array);

/** \brief Like asNumbers(). \throws type_error if it is no array */
py::array numbersOf(const py::handle& array);

/** \brief Whether fork() created this process after the module was loaded. */
bool isForked();

/** \brief Returns the result of \a work; other Python threads may run meanwhile. */
template <typename Work>
auto
released(Work&& work)
{
  const py::gil_scoped_release others_may_run;
  // A forked process has none of OpenMP's threads, and a thread that used them before
  // would wait for them forever. A new thread starts its own.
  if (isForked())
    return std::async(std::launch::async, std::forward<Work>(work)).get();
  return work();
}

/** \brief Warns by Python's warnings. \throws py::error_already_set if warnings are
 * errors */
void warn(const std::string& message);

/** \brief Shape as text: "480 x 640 x 3"; "one number" without axes. */
std::string shapeOf(const py::array& array);

/** \brief Requires the shape \a rows, or \a rows x \a columns. An empty list, which has
 * one axis in numpy, counts as zero rows of any columns.
 * \throws InvalidParameterException that names the array */
void requireShape(const py::array& array, const char* name, py::ssize_t rows,
                  std::optional<py::ssize_t> columns = std::nullopt);

/** \throws InvalidParameterException unless the array contains integers (or is
 * empty) */
void requireIntegers(const py::array& array, const char* name);

/** \brief Whether an integer of 64 bits is within the range of another type. */
template <typename To, typename From>
bool
fitsInto(From value)
{
  if constexpr (std::is_signed_v<From>)
    if (value < 0)
      return std::is_signed_v<To> && value >= From(std::numeric_limits<To>::min());
  return std::uint64_t(value) <= std::uint64_t(std::numeric_limits<To>::max());
}

/** \throws InvalidParameterException that names an integer outside the range of T */
template <typename T, typename Wide>
void
requireRange(const Array<Wide>& values, const char* name)
{
  for (py::ssize_t i = 0; i < values.size(); ++i)
    if (!fitsInto<T>(values.data()[i]))
      badParameter(name, " hold ", values.data()[i], ", expected ",
                   std::is_signed_v<T> ? "at most " : "0 to ",
                   std::uint64_t(std::numeric_limits<T>::max()));
}

/** \brief Converts integers to another integer type.
 * \throws InvalidParameterException that names the array, if the numbers are no
 * integers or one is out of range, for example colours from 0 to 1 */
template <typename T>
Array<T>
integersOf(const py::object& values, const char* name)
{
  const py::array array = numbersOf(values);
  if (array.dtype().equal(py::dtype::of<T>()))
    return Array<T>(array);
  requireIntegers(array, name);
  if (array.dtype().kind() == 'u')
    requireRange<T>(Array<std::uint64_t>(array), name);
  else
    requireRange<T>(Array<std::int64_t>(array), name);
  return Array<T>(array);
}

/** \brief The same conversion for an optional array. */
template <typename T>
MaybeArray<T>
maybeIntegersOf(const py::object& values, const char* name)
{
  return values.is_none() ? std::nullopt : MaybeArray<T>(integersOf<T>(values, name));
}

/** \brief Converts a number to a label and removes its instance.
 * \param[in] name of the array
 * \param[in] point index of the number, for the message
 * \throws BadInputException unless the label is 0 to 255 */
Label labelOf(std::int64_t number, const char* name, std::size_t point);

/** \throws InvalidParameterException unless an output name ends in .pcd */
void requirePcdName(const std::string& path);

/** \brief Sets parameters by their names in YAML files.
 * \throws TypeError at an unknown name */
void setParameters(const ConfigParameters& parameters, const py::kwargs& values);

/** \brief Refuses given parameters without effect.
 * \param[in] condition end of the message: "without camera="
 * \throws InvalidParameterException that names the parameter and the condition */
void refuseUnread(const py::kwargs& given, const std::vector<std::string>& unread,
                  const std::string& condition);

/** \brief Refuses parameters of a CRF without effect, see unreadParametersOfCRF(). */
void refuseUnreadOfCRF(const py::kwargs& given, const std::string& model,
                       const std::string& cliques);

/** \brief Reads a label set from its file, or an installed one by its name. */
LabelSet labelSetOf(const std::string& path_or_name);

/** \brief Warns of positions whose type has steps coarser than a tenth of a voxel: far
 * positions in single or half precision.
 * \param[in] given the original array, for its type
 * \param[in] positions the same, 3 x N [m]
 * \param[in] name of the array, for the message */
void warnOfSteps(const py::array& given,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& positions, double voxel_size,
                 const char* name);

/** \brief Converts 4 x 4 numbers to T_world_sensor. Warns of a position degraded by
 * single precision.
 * \param[in] voxel_size of the map [m] */
Eigen::Isometry3d poseOf(const py::object& pose, double voxel_size);

/** \brief A cloud whose positions are relative to an origin, see localOrigin() [m]. */
struct LocalCloud {
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/** \brief Makes a cloud from N x 3 positions of any type [m] and optional N x 3
 * colours. Warns of positions degraded by single precision. */
LocalCloud localCloudOf(const py::object& points,
                        const MaybeArray<std::uint8_t>& colours);

/** \brief Makes the fields of a cloud from the same, with labels 0. */
CloudFields cloudFieldsOf(const py::object& points,
                          const MaybeArray<std::uint8_t>& colours);

/** \brief Makes a scan from N x 3 positions in the sensor's frame [m] and optional N x
 * 3 colours. Warns of positions degraded by single precision, which are probably in the
 * world's frame. */
pcl::PointCloud<pcl::PointXYZRGBL>::Ptr scanOf(const py::object& points,
                                               const MaybeArray<std::uint8_t>& colours);

/** \brief Converts N x L probabilities, None = none. As in files, a row must sum to 1
 * within 0.1, or be all zero: unlabelled.
 * \throws BadInputException that names another row */
LabelDistributions distributionsOf(const py::object& probabilities, py::ssize_t points);

/** \brief Converts back to an array, without a copy. */
py::array_t<float> arrayOf(LabelDistributions distributions);

/** \brief Labels of a cloud. */
py::array_t<std::uint8_t> labelsOf(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud);

/** \brief Converts voxels to a dict: points (double, world frame), colours, labels,
 * probabilities, observations and indices. */
py::dict dictOf(VoxelCloud voxels);

/** \brief Binds refine(), cliques(). */
void bindClouds(py::module_& module);

/** \brief Binds SemanticVoxelMap, SemanticMapper, load_map(). */
void bindMaps(py::module_& module);

/** \brief Binds confusion_matrix(), scores(). */
void bindEvaluation(py::module_& module);

/** \brief Binds read_cloud(), write_cloud(). */
void bindFiles(py::module_& module);

} // namespace pcl_semantic::python

namespace pybind11::detail {

template <typename T> struct pyobject_caster<pcl_semantic::python::Array<T>> {
  using type = pcl_semantic::python::Array<T>;
  PYBIND11_TYPE_CASTER(type, const_name("numpy.ndarray"));

  bool
  load(handle source, bool)
  {
    const array any = pcl_semantic::python::asNumbers(source);
    if (!any)
      return false;
    value = type(any);
    return true;
  }

  static handle
  cast(const handle& source, return_value_policy, handle)
  {
    return source.inc_ref();
  }
};

template <> struct type_caster<pcl_semantic::python::Path> {
  PYBIND11_TYPE_CASTER(pcl_semantic::python::Path, const_name("os.PathLike"));

  bool
  load(handle source, bool)
  {
    PyObject* bytes = nullptr;
    if (PyUnicode_FSConverter(source.ptr(), &bytes) == 0) {
      if (!PyErr_ExceptionMatches(PyExc_TypeError))
        throw error_already_set();
      PyErr_Clear();
      return false;
    }
    value.text = reinterpret_steal<pybind11::bytes>(bytes);
    return true;
  }
};

} // namespace pybind11::detail
