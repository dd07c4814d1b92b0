include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/pcl_semantic)
install(TARGETS pcl_semantic EXPORT pcl_semantic_targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/pcl_semantic DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${PROJECT_BINARY_DIR}/include/pcl_semantic/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pcl_semantic)
install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pcl_semantic)
install(EXPORT pcl_semantic_targets NAMESPACE pcl_semantic:: DESTINATION ${package_folder})
configure_package_config_file(cmake/pcl_semantic-config.cmake.in
  ${PROJECT_BINARY_DIR}/pcl_semantic-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pcl_semantic-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/pcl_semantic-config.cmake
  ${PROJECT_BINARY_DIR}/pcl_semantic-config-version.cmake
  cmake/dependencies.cmake
  DESTINATION ${package_folder})
