# No -march or -mavx here, ever: code built with them that sees Eigen or PCL types
# corrupts the objects of Debian's PCL. Fast paths pick their instructions at run time.
function(pcl_semantic_compiler_options target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wshadow -Wpedantic -Werror -ffp-contract=off)
  # PCL's heavy headers are parsed once a target.
  target_precompile_headers(${target} PRIVATE
    <pcl/point_cloud.h> <pcl/point_types.h> <opencv2/core.hpp> <Eigen/Geometry>
    <algorithm> <cmath> <filesystem> <functional> <memory> <string> <vector>)
  if(PCL_SEMANTIC_SANITIZE)
<<<<<<< HEAD
    # Under the address sanitizer Eigen would take its own allocator, and memory that
    # passes between us and Debian's PCL would be freed by the wrong one.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    # GCC 12 takes parts of <regex> for uninitialized when it instruments them.
=======
    # Under ASan Eigen would allocate in another way than Debian's PCL frees.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
    # g++ 12 sees uninitialised members in its own <regex> under sanitizers.
>>>>>>> 5d8248aa2b6330635a1c4a49142ffcc8573a4155
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized
      -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=address,undefined)
  endif()
endfunction()
