# Eigen aligns to 16 bytes, with AVX to 32 and with AVX-512 to 64, and frees memory
# accordingly: PCL, this library and every program have to agree. What they agree on is
# written into <pcl_semantic/core/alignment.h>; <pcl_semantic/core/export.h> compares.

# What cmake/alignment.cpp says of <flags>, together with those that PCL asks for itself.
function(pcl_semantic_probe flags alignment said)
  set(CMAKE_CXX_FLAGS "${flags}")
  set(CMAKE_TRY_COMPILE_CONFIGURATION None)
  set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
  try_compile(compiled ${PROJECT_BINARY_DIR}/alignment
    ${PROJECT_SOURCE_DIR}/cmake/alignment.cpp
    LINK_LIBRARIES pcl_common OUTPUT_VARIABLE text)
  if(NOT text MATCHES "\"alignment: ([0-9]+)\"")
    message(FATAL_ERROR "The compiler does not take the flags '${flags}':\n${text}")
  endif()
  set(${alignment} ${CMAKE_MATCH_1} PARENT_SCOPE)
  set(${said} "${text}" PARENT_SCOPE)
endfunction()

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
pcl_semantic_probe("${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}" ours said)
pcl_semantic_probe("" PCL_SEMANTIC_ALIGNMENT unused)
if(said MATCHES "\"allowed by hand\"")
  set(PCL_SEMANTIC_ALIGNMENT ${ours})
elseif(said MATCHES "\"PCL aligns by hand\"" AND PCL_SEMANTIC_ALIGNMENT EQUAL 16)
  set(PCL_SEMANTIC_ALIGNMENT 32) # compiled with flags that it does not ask for
  if(ours GREATER 32)
    set(PCL_SEMANTIC_ALIGNMENT ${ours})
  endif()
endif()
if(NOT ours EQUAL PCL_SEMANTIC_ALIGNMENT)
  message(FATAL_ERROR "PCL (${PCL_DIR}) was compiled so that Eigen aligns to \
${PCL_SEMANTIC_ALIGNMENT} bytes; the compiler flags here have it align to ${ours}, and \
PCL's objects would be corrupted. Compile both with the same flags for AVX, or with none. \
If they are the same and PCL does not say so (before 1.15), add \
-DPCL_SEMANTIC_ALLOW_AVX to CMAKE_CXX_FLAGS.")
endif()
configure_file(cmake/alignment.h.in include/pcl_semantic/core/alignment.h @ONLY)
