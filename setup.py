# SPDX-License-Identifier: BSD-3-Clause
"""pip install . : compiles the library and the module of Python with CMake.

Needs the packages of a build from source (./dev installs them), and pybind11-dev.
"""

import os
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext


class BuildWithCMake(build_ext):
    def build_extension(self, extension):
        source = os.path.dirname(os.path.abspath(__file__))
        folder = os.path.dirname(os.path.abspath(self.get_ext_fullpath(extension.name)))
        build = os.path.abspath(self.build_temp)
        libraries = os.path.join(folder, "pcl_semantic.libs")
        off = [f"-DPCL_SEMANTIC_BUILD_{part}=OFF" for part in
               ("APPS", "VIEWER", "EXAMPLES", "TESTS")]
        subprocess.run(
            ["cmake", "-S", source, "-B", build, "-DCMAKE_BUILD_TYPE=Release",
             "-DPCL_SEMANTIC_BUILD_PYTHON=ON", "-DPCL_SEMANTIC_PYTHON_FOLDER=.",
             f"-DPython_EXECUTABLE={sys.executable}", "-DCMAKE_INSTALL_LIBDIR=lib",
             "-DCMAKE_INSTALL_RPATH=$ORIGIN/pcl_semantic.libs/lib"] + off, check=True)
        subprocess.run(["cmake", "--build", build, "--parallel", str(os.cpu_count()),
                        "--target", "pcl_semantic_python"], check=True)
        for component, prefix in [("library", libraries), ("python", folder)]:
            subprocess.run(["cmake", "--install", build, "--component", component,
                            "--prefix", prefix], check=True)


setup(
    name="pcl_semantic",
    version="0.1.0",  # that of CMakeLists.txt
    description="Semantic 3D occupancy mapping for PCL",
    license="BSD-3-Clause",
    python_requires=">=3.9",
    install_requires=["numpy"],
    ext_modules=[Extension("pcl_semantic", [])],
    packages=[],
    cmdclass={"build_ext": BuildWithCMake},
)
