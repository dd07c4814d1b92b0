// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/pipeline/config_parameter.h>

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
#include <vector>

namespace pcl_semantic::python {

namespace py = pybind11;

/** \brief Of this type and row by row: converted if it is not, else without a copy.
 * Complex numbers are refused: numpy would drop a part of them. */
template <typename T>
class Array : public py::array_t<T, py::array::c_style | py::array::forcecast> {
public:
  using py::array_t<T, py::array::c_style | py::array::forcecast>::array_t;
};

/** \brief A path: str, bytes or os.PathLike. A NUL in it is a ValueError. */
struct Path {
  std::string text;

  operator const std::string&() const { return text; }
};

template <typename T> using MaybeArray = std::optional<Array<T>>;

constexpr py::ssize_t kAny = -1; ///< number of rows or columns

/** \brief An array of real numbers, of which numpy would drop nothing: the mask of
 * numpy.ma, an imaginary part, the unit of a time. \return null if it is no array
 * \throws value_error */
py::array asNumbers(const py::handle& array);

/** \brief The same. \throws type_error if it is no array */
py::array numbersOf(const py::handle& array);

/** \brief Whether fork() has made this process since the module was loaded. */
bool isForked();

/** \brief What \a work gives; other threads of Python may run meanwhile. */
template <typename Work>
auto
released(Work&& work)
{
  const py::gil_scoped_release others_may_run;
  // A fork takes none of OpenMP's threads along, and the thread that had begun them
  // would wait for them for ever. Another one begins its own.
  if (isForked())
    return std::async(std::launch::async, std::forward<Work>(work)).get();
  return work();
}

/** \brief Warns as Python does. \throws py::error_already_set if warnings are errors */
void warn(const std::string& message);

/** \brief Shape of an array: \a rows, or \a rows x \a columns.
 * \throws InvalidParameterException that names it */
void requireShape(const py::array& array, const char* name, py::ssize_t rows,
                  std::optional<py::ssize_t> columns = std::nullopt);

/** \throws InvalidParameterException unless the array holds integers (or nothing) */
void requireIntegers(const py::array& array, const char* name);

/** \throws InvalidParameterException unless 0 <= value <= largest */
void requireWithin(std::int64_t value, std::int64_t largest, const char* name);

/** \brief Whole numbers of any kind as another kind of them.
 * \throws InvalidParameterException that names them, if they are no integers, or one is
 * not within the range of the other kind: as colours from 0 to 1 */
template <typename T>
Array<T>
integersOf(const py::object& values, const char* name)
{
  const py::array array = numbersOf(values);
  requireIntegers(array, name);
  const Array<std::int64_t> wide(array);
  if constexpr (sizeof(T) < sizeof(std::int64_t))
    for (py::ssize_t i = 0; i < wide.size(); ++i)
      requireWithin(wide.data()[i], std::numeric_limits<T>::max(), name);
  return Array<T>(wide);
}

/** \brief The same of what may be None. */
template <typename T>
MaybeArray<T>
maybeIntegersOf(const py::object& values, const char* name)
{
  return values.is_none() ? std::nullopt : MaybeArray<T>(integersOf<T>(values, name));
}

/** \throws InvalidParameterException unless a name to write ends in .pcd */
void requirePcdName(const std::string& path);

/** \brief Sets parameters that are called as in YAML files.
 * \throws TypeError at a name that there is not */
void setParameters(const ConfigParameters& parameters, const py::kwargs& values);

/** \brief A label set by its file, or by the name of one that comes along. */
LabelSet labelSetOf(const std::string& path_or_name);

/** \brief T_world_sensor of 4 x 4 numbers. */
Eigen::Isometry3d poseOf(const Array<double>& pose);

/** \brief A cloud whose positions are relative to an origin, see localOrigin() [m]. */
struct LocalCloud {
  pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/** \brief Warns of positions that single precision has spoilt, see doubtOfSteps(): of a
 * scan, which is in the frame of its sensor, those that are in the world's. */
void warnOfSteps(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud,
                 const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/** \brief N x 3 positions of any type [m] and, if there are any, N x 3 colours. Warns
 * of positions that single precision has spoilt. */
LocalCloud localCloudOf(const py::object& points,
                        const MaybeArray<std::uint8_t>& colours);

/** \brief N x 3 positions [m] and, if there are any, N x 3 colours. */
pcl::PointCloud<pcl::PointXYZRGBL>::Ptr
cloudOf(const Array<float>& points, const MaybeArray<std::uint8_t>& colours);

/** \brief N x L in rows is L x N in columns: the bytes are the same. Nothing = none. */
LabelDistributions distributionsOf(const MaybeArray<float>& rows, py::ssize_t points);

/** \brief The same back, without a copy. */
py::array_t<float> arrayOf(LabelDistributions distributions);

/** \brief Labels of a cloud. */
py::array_t<std::uint8_t> labelsOf(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud);

/** \brief points (double, world frame), colours, labels, probabilities, observations
 * and indices of voxels. */
py::dict dictOf(VoxelCloud voxels);

/** \brief refine(), cliques(). */
void bindClouds(py::module_& module);

/** \brief SemanticVoxelMap, SemanticMapper, load_map(). */
void bindMaps(py::module_& module);

/** \brief confusion_matrix(), scores(). */
void bindEvaluation(py::module_& module);

/** \brief read_cloud(), write_cloud(). */
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
