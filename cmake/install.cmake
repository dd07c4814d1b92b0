# Components of the installation: library (all seven, with their data), dev, tools, fleet
# and viewer (apps/CMakeLists.txt), python (python/CMakeLists.txt) and doc.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/pcl_semantic)
install(TARGETS pcl_semantic EXPORT pcl_semantic_targets) # the libraries: src/library.cmake
install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pcl_semantic
  COMPONENT library)

install(DIRECTORY include/pcl_semantic DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/include/pcl_semantic/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcl_semantic COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/include/pcl_semantic/core/alignment.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcl_semantic/core COMPONENT dev)
install(EXPORT pcl_semantic_targets NAMESPACE pcl_semantic::
  DESTINATION ${package_folder} COMPONENT dev)
configure_package_config_file(cmake/pcl_semantic-config.cmake.in
  ${PROJECT_BINARY_DIR}/pcl_semantic-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcl_semantic-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/pcl_semantic-config.cmake
  ${PROJECT_BINARY_DIR}/pcl_semantic-config-version.cmake
  DESTINATION ${package_folder} COMPONENT dev)
file(RELATIVE_PATH path_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
# For pkg-config: one description a library, and one of all.
function(pcl_semantic_description name needs libs)
  set(needs_headers ${ARGN})
  configure_file(cmake/pcl_semantic.pc.in ${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endfunction()
pcl_semantic_description(pcl_semantic_core "eigen3 pcl_common" -lpcl_semantic_core)
# Without its description, which would bring what MPI needs.
pcl_semantic_description(pcl_semantic_crf pcl_semantic_core
  "-lpcl_semantic_crf -lpcl_filters")
pcl_semantic_description(pcl_semantic_map pcl_semantic_core -lpcl_semantic_map)
pcl_semantic_description(pcl_semantic_io "pcl_semantic_map pcl_semantic_crf"
  -lpcl_semantic_io)
# Of OpenCV the headers and one library: opencv4.pc would link all sixty.
pcl_semantic_description(pcl_semantic_vision "pcl_semantic_crf pcl_semantic_io"
  "-lpcl_semantic_vision -lopencv_core" opencv4)
pcl_semantic_description(pcl_semantic_pipeline pcl_semantic_vision -lpcl_semantic_pipeline)
pcl_semantic_description(pcl_semantic_capture pcl_semantic_vision -lpcl_semantic_capture)
pcl_semantic_description(pcl_semantic "pcl_semantic_pipeline pcl_semantic_capture" "")

# For colcon and ROS, which look for packages by these two.
install(FILES package.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/pcl_semantic COMPONENT dev)
file(WRITE ${PROJECT_BINARY_DIR}/ament_index "")
install(FILES ${PROJECT_BINARY_DIR}/ament_index RENAME pcl_semantic
  DESTINATION ${CMAKE_INSTALL_DATADIR}/ament_index/resource_index/packages COMPONENT dev)

if(PCL_SEMANTIC_BUILD_APPS)
  install(EXPORT pcl_semantic_tools_targets NAMESPACE pcl_semantic::
    DESTINATION ${package_folder} COMPONENT tools)
endif()

install(FILES README.md CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY doc DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc
  FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*_head.md" EXCLUDE)
install(DIRECTORY apps/examples apps/synthesize # sources, to read and to compile
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/apps COMPONENT doc
  FILES_MATCHING PATTERN "*.cpp" PATTERN "*.h")
