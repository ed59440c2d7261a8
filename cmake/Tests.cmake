# brickbench_test(NAME [DENSE] SOURCES ... LINK ...): a GoogleTest binary whose tests CTest lists one
# by one as NAME.Suite.Case. Tests run in the source directory, so relative paths of data are the
# clone's. Without LABELS the label is the first word of NAME, up to `_`: unit_seam has the label
# unit. The target unit_tests builds all tests of that label. DENSE: the test does much dense algebra,
# too slow under the sanitizers without optimisation.
brickbench_require(GTest libgtest-dev)
include(GoogleTest)

add_custom_target(unit_tests)
brickbench_header_set(brickbench_headers_test <gtest/gtest.h>)
target_link_libraries(brickbench_headers_test PRIVATE GTest::gtest)
brickbench_light_options(brickbench_headers_test)

function(brickbench_test name)
  cmake_parse_arguments(ARG "DENSE" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(NOT ARG_LABELS)
    string(REGEX REPLACE "_.*" "" ARG_LABELS ${name})
  endif()
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(unit_tests ${name})
  endif()
  add_executable(${name} ${ARG_SOURCES})
  if(NOT (ARG_DENSE AND BRICKBENCH_SANITIZE))
    brickbench_light_options(${name})
    brickbench_headers_of(${name} brickbench_headers_test)
  endif()
  brickbench_together(${name})
  target_link_libraries(${name} PRIVATE brickbench_options brickbench_test_support
                        ${ARG_LINK} GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  gtest_discover_tests(${name} TEST_PREFIX ${name}. WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
                       DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()
