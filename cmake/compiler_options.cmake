# Errors for those who work on it (./dev) with a compiler they know; next year's compiler
# warns of more and has to build a release all the same.
option(PCL_SEMANTIC_WARNINGS_AS_ERRORS "Stop at compiler warnings" OFF)
set(PCL_SEMANTIC_WARNINGS -Wall -Wextra -Wshadow -Wpedantic
  $<$<BOOL:${PCL_SEMANTIC_WARNINGS_AS_ERRORS}>:-Werror>)

# No -march or -mavx here, ever: code built with them that sees Eigen or PCL types
# corrupts the objects of Debian's PCL. Fast paths pick their instructions at run time.
# pcl_semantic_compiler_options(<target> <group> [<headers>]): the targets of a group have
# the same definitions, so that they share what is parsed once, these headers too.
function(pcl_semantic_compiler_options target group)
  target_compile_options(${target} PRIVATE ${PCL_SEMANTIC_WARNINGS} -ffp-contract=off)
  if(group STREQUAL tests)
    # A third of the time to compile; GCC 12 then takes parts of Eigen for uninitialized.
    target_compile_options(${target} PRIVATE -O1
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endif()
  # PCL's heavy headers take 10 s: they are parsed once a group, by its first target.
  get_property(first GLOBAL PROPERTY pcl_semantic_first_of_${group})
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    set_property(GLOBAL PROPERTY pcl_semantic_first_of_${group} ${target})
    target_precompile_headers(${target} PRIVATE
      <pcl/point_cloud.h> <pcl/point_types.h> <Eigen/Geometry>
      <algorithm> <cmath> <filesystem> <functional> <memory> <string> <vector> ${ARGN})
  endif()
  if(PCL_SEMANTIC_SANITIZE)
    # Under the address sanitizer Eigen would take its own allocator, and memory that
    # passes between us and Debian's PCL would be freed by the wrong one.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    # GCC 12 takes parts of <regex> for uninitialized when it instruments them.
    target_compile_options(${target} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
      -fsanitize=${PCL_SEMANTIC_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${PCL_SEMANTIC_SANITIZE})
    if(PCL_SEMANTIC_SANITIZE STREQUAL "address")
      target_link_options(${target} PRIVATE -fsanitize=undefined)
      # Behaviour is ours to check, not that of the tests, which then compile in two
      # thirds.
      if(NOT group STREQUAL tests)
        # Without those that the address sanitizer makes superfluous (a null pointer, the
        # size of an object) or that no platform of ours minds: they take half of the time
        # to compile.
        target_compile_options(${target} PRIVATE
          -fsanitize=undefined -fno-sanitize-recover=undefined
          -fno-sanitize=null,object-size,vptr,pointer-overflow,alignment)
      endif()
    endif()
  endif()
endfunction()
