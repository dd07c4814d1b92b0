if(POLICY CMP0144)
  cmake_policy(SET CMP0144 NEW) # PCL's own modules say FLANN_ROOT
endif()
# What an installed package finds again: cmake/pcl_semantic-config.cmake.in.
find_package(Eigen3 REQUIRED)
find_package(PCL 1.12 REQUIRED COMPONENTS common filters)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs calib3d dnn
  features2d video videoio)

# PCL's component "segmentation" would want VTK, MPI and a C compiler: the libraries alone,
# with those that it is made of itself.
set(PCL_SEGMENTATION_LIBRARIES)
foreach(name segmentation features ml)
  find_library(PCL_${name}_FILE pcl_${name} REQUIRED)
  list(APPEND PCL_SEGMENTATION_LIBRARIES ${PCL_${name}_FILE})
endforeach()
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(yaml-cpp REQUIRED)
set(YAML_CPP_TARGET yaml-cpp::yaml-cpp)
if(NOT TARGET yaml-cpp::yaml-cpp) # before 0.8
  set(YAML_CPP_TARGET yaml-cpp)
endif()
find_package(nlohmann_json REQUIRED)
find_package(Boost REQUIRED CONFIG COMPONENTS program_options)
find_package(SQLite3 REQUIRED)
find_package(zstd REQUIRED)
find_package(octomap REQUIRED)
find_package(hwy REQUIRED)

# Half again to twice as fast as OpenCV with networks; Debian has it from 13 on.
find_package(onnxruntime QUIET)

# pcl_semantic_fleet alone, which works on one machine without them.
find_package(MPI QUIET COMPONENTS CXX)
find_package(Boost QUIET CONFIG COMPONENTS mpi)

# pcl_semantic_view alone. PCL's component would want all of VTK, MPI included.
if(PCL_SEMANTIC_BUILD_APPS AND PCL_SEMANTIC_BUILD_VIEWER)
  enable_language(C) # VTK's package looks for libraries with it
  find_library(PCL_VISUALIZATION_LIBRARY pcl_visualization REQUIRED)
  find_package(VTK 9 REQUIRED COMPONENTS CommonCore CommonDataModel CommonExecutionModel
    InteractionStyle RenderingCore RenderingLOD RenderingOpenGL2)
  find_package(X11 REQUIRED)
endif()
