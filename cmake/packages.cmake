# Debian packages, one a component of cmake/install.cmake: ./dev package (doc/packaging.md).
set(library_package libpcl-semantic${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(same_library "${library_package} (= ${PROJECT_VERSION})")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pcl-semantic)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # it would stand before each package's own
set(CPACK_PACKAGE_CONTACT "the pcl_semantic developers" CACHE STRING
  "Whom a package names as its maintainer: NAME <MAIL>")
set(CPACK_COMPONENTS_ALL library dev tools doc)
if(PCL_SEMANTIC_BUILD_APPS AND PCL_SEMANTIC_BUILD_VIEWER)
  list(APPEND CPACK_COMPONENTS_ALL viewer)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY >=)
# Where the programs' library is while it is not installed.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})

# pcl_semantic_package(<component> <package> <section> <what it holds>)
macro(pcl_semantic_package component package section what)
  string(TOUPPER ${component} name)
  set(CPACK_DEBIAN_${name}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${name}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${name}_DESCRIPTION "${PROJECT_DESCRIPTION}: ${what}
Stereo frames or labelled clouds of any sensor go into a scrolling occupancy grid,
every voxel fuses the class distributions of what hit it, and a dense or
hierarchical CRF makes the labels consistent.")
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package}
    RENAME copyright COMPONENT ${component})
endmacro()

pcl_semantic_package(library ${library_package} libs "library")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)

pcl_semantic_package(dev libpcl-semantic-dev libdevel "headers")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "${same_library}, libpcl-dev (>= 1.12), libopencv-dev, libeigen3-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake | pkgconf, pcl-semantic-doc")

pcl_semantic_package(tools pcl-semantic-tools science "programs")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "${same_library}")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "pcl-semantic-viewer, pcl-tools, pcl-semantic-doc")

pcl_semantic_package(viewer pcl-semantic-viewer science "viewer") # VTK is large
set(CPACK_DEBIAN_VIEWER_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_VIEWER_PACKAGE_DEPENDS "${same_library}")
set(CPACK_DEBIAN_VIEWER_PACKAGE_RECOMMENDS "xvfb, xauth") # --screenshot without a display

pcl_semantic_package(doc pcl-semantic-doc doc "documentation")
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)

include(CPack)
