# Libraries that the project itself needs. The engines are looked for in adapters/.
# Every missing library is named with the Debian package that holds it.
function(brickbench_require name package)
  find_package(${name} ${ARGN} QUIET)
  if(NOT ${name}_FOUND)
    message(FATAL_ERROR "brickbench needs ${name}: install the Debian package ${package} "
                        "(scripts/install-deps.sh installs everything)")
  endif()
  set(${name}_FOUND TRUE PARENT_SCOPE)
endfunction()

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
brickbench_require(Eigen3 libeigen3-dev)
brickbench_require(fmt libfmt-dev)
brickbench_require(CLI11 libcli11-dev)
brickbench_require(nlohmann_json nlohmann-json3-dev)
brickbench_require(tomlplusplus libtomlplusplus-dev)
brickbench_require(muparser libmuparser-dev)

# Header-only packages without a CMake config: name, header, path suffix, Debian package.
function(brickbench_header_library target header suffix package)
  find_path(${target}_INCLUDE_DIR ${header} PATH_SUFFIXES ${suffix})
  if(NOT ${target}_INCLUDE_DIR)
    message(FATAL_ERROR "brickbench needs <${header}>: install the Debian package ${package} "
                        "(scripts/install-deps.sh installs everything)")
  endif()
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${${target}_INCLUDE_DIR})
endfunction()

brickbench_header_library(tl_expected tl/expected.hpp "" libexpected-dev)
brickbench_header_library(fast_cpp_csv csv.h libfccp libfccp-dev)
brickbench_header_library(xxhash xxhash.h "" libxxhash-dev)
target_compile_definitions(xxhash INTERFACE XXH_INLINE_ALL)
target_link_libraries(fast_cpp_csv INTERFACE Threads::Threads)

# SQLite, for `sweep merge --sqlite`; without it the program is built and refuses that option.
option(BRICKBENCH_SQLITE "Merge sweeps to databases, if SQLite is there" ON)
if(BRICKBENCH_SQLITE)
  pkg_search_module(SQLITE QUIET IMPORTED_TARGET sqlite3)
endif()
if(BRICKBENCH_SQLITE AND SQLITE_FOUND)
  message(STATUS "brickbench: databases with SQLite ${SQLITE_VERSION}")
else()
  message(STATUS "brickbench: no databases: SQLite is missing, the Debian package libsqlite3-dev")
endif()
