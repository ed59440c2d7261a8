# Headers that most files read are compiled once per set of options and then taken from there: each
# file costs some three seconds less. CMAKE_DISABLE_PRECOMPILE_HEADERS=ON compiles every file for
# itself, and so finds the one that forgets an include.
set(brickbench_common_headers
  <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <filesystem> <functional> <limits> <map>
  <memory> <optional> <span> <string> <string_view> <variant> <vector> <fmt/format.h>
  <tl/expected.hpp>)

# A library that compiles nothing else than headers, with the options of its kind.
function(brickbench_header_set name)
  file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/headers/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/headers/${name}.cpp)
  target_link_libraries(${name} PRIVATE brickbench_options Eigen3::Eigen tl_expected fmt::fmt)
  target_precompile_headers(${name} PRIVATE ${brickbench_common_headers} ${ARGN})
endfunction()

# A compiler cache tells files apart by what the headers hold.
target_compile_options(brickbench_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
brickbench_header_set(brickbench_headers)
brickbench_header_set(brickbench_headers_light)
brickbench_light_options(brickbench_headers_light)

# brickbench_headers_of(TARGET SET): takes the common headers from a set with the same options.
function(brickbench_headers_of target set)
  target_link_libraries(${target} PRIVATE fmt::fmt)
  target_precompile_headers(${target} REUSE_FROM ${set})
endfunction()
