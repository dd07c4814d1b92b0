// SPDX-License-Identifier: BSD-3-Clause

// import pcl_semantic: numpy arrays as input and output (doc/python.md).

#include "arrays.h"
#include "cameras.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/version.h>

PYBIND11_MODULE(pcl_semantic, module)
{
  using namespace pcl_semantic;
  module.doc() = "Semantic 3D occupancy maps, and a CRF over labelled clouds.";
  module.attr("__version__") = PCL_SEMANTIC_VERSION;
  pybind11::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown)
        std::rethrow_exception(thrown);
    }
    catch (const OutputException& error) {
      PyErr_SetString(PyExc_OSError, error.what());
    }
    catch (const Exception& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    }
  });
  python::bindClouds(module);
  python::bindMaps(module);
  python::bindEvaluation(module);
  python::bindFiles(module);
  python::bindCameras(module);
}
