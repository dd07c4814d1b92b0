# pcl_semantic_library(<name> MODULES <folder>... PUBLIC <library>... PRIVATE
# <library>...): libpcl_semantic_<name>, as the target pcl_semantic::<name>. The targets
# pcl_semantic_<name> are programs.
set(PCL_SEMANTIC_LIBRARIES)
function(pcl_semantic_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "MODULES;PUBLIC;PRIVATE")
  set(library pcl_semantic_${name}_library)
  add_library(${library} SHARED)
  add_library(pcl_semantic::${name} ALIAS ${library})
  target_include_directories(${library} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_include_directories(${library} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_compile_features(${library} PUBLIC cxx_std_17)
  target_link_libraries(${library} PUBLIC ${arg_PUBLIC}
    PRIVATE ${arg_PRIVATE} hwy::hwy OpenMP::OpenMP_CXX)
  set_target_properties(${library} PROPERTIES
    EXPORT_NAME ${name}
    OUTPUT_NAME pcl_semantic_${name}
    DEFINE_SYMBOL "" # precompiled headers are shared
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    INSTALL_RPATH $ORIGIN)
  # Hidden is all but what <pcl_semantic/core/export.h> marks. clang applies a
  # namespace's mark to the declarations inside only, and would hide the functions
  # defined elsewhere.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set_target_properties(${library} PROPERTIES
      CXX_VISIBILITY_PRESET hidden
      VISIBILITY_INLINES_HIDDEN ON)
  endif()
  # PCL's targets name more libraries than a library uses, and what it uses has to be
  # below it. The symbols of sanitizers are the program's.
  target_link_options(${library} PRIVATE -Wl,--as-needed)
  if(NOT PCL_SEMANTIC_SANITIZE)
    target_link_options(${library} PRIVATE -Wl,--no-undefined)
  endif()
  if(opencv_core IN_LIST arg_PUBLIC OR pcl_semantic::vision IN_LIST arg_PUBLIC)
    pcl_semantic_compiler_options(${library} images <opencv2/core.hpp>)
  else()
    pcl_semantic_compiler_options(${library} library)
  endif()
  foreach(module IN LISTS arg_MODULES)
    add_subdirectory(${module})
  endforeach()
  get_target_property(sources ${library} SOURCES)

  # Hot loops see neither Eigen nor PCL.
  set(kernels ${sources})
  list(FILTER kernels INCLUDE REGEX "/kernels/")
  set_source_files_properties(${kernels} TARGET_DIRECTORY ${library}
    PROPERTIES SKIP_PRECOMPILE_HEADERS ON)

  # What reads files tells the fuzzers (test/fuzz) which way it takes; hot loops that do
  # so take three times as long.
  if(PCL_SEMANTIC_SANITIZE STREQUAL "address" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    set(readers ${sources})
    list(FILTER readers INCLUDE REGEX
      "/(clouds|files|images|dataset|labelling|evaluation|io|pictures|pipeline)/")
    set_source_files_properties(${readers} TARGET_DIRECTORY ${library}
      PROPERTIES COMPILE_OPTIONS -fsanitize=fuzzer-no-link SKIP_PRECOMPILE_HEADERS ON)
  endif()

  install(TARGETS ${library} EXPORT pcl_semantic_targets
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT dev)
  set(PCL_SEMANTIC_LIBRARIES ${PCL_SEMANTIC_LIBRARIES} ${name} PARENT_SCOPE)
endfunction()
