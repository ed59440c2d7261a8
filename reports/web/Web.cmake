# The page's style and script, bundled from the sources here and written as C++ into the build tree.
#
# BRICKBENCH_WEB = AUTO | ON | OFF. The script needs Node and npm; its third-party modules come by
# the lock file into the build tree when the project is built and are never committed. Under AUTO a
# build without Node, or without a package host in reach, makes pages with static figures that say so.
set(BRICKBENCH_WEB AUTO CACHE STRING "Embed the interactive page: AUTO, ON or OFF")
set_property(CACHE BRICKBENCH_WEB PROPERTY STRINGS AUTO ON OFF)
find_program(BRICKBENCH_NODE node)
find_program(BRICKBENCH_NPM npm)

set(web_missing "")
if(BRICKBENCH_WEB STREQUAL "OFF")
  set(web_missing "the program was built with BRICKBENCH_WEB=OFF")
elseif(NOT BRICKBENCH_NODE OR NOT BRICKBENCH_NPM)
  set(web_missing "the program was built without Node; install nodejs and npm and build again")
  if(BRICKBENCH_WEB STREQUAL "ON")
    message(FATAL_ERROR "brickbench: BRICKBENCH_WEB=ON needs node and npm")
  endif()
  message(STATUS "brickbench: no Node: reports get static figures and no 3D view; install nodejs npm")
endif()

set(page_assets_file ${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp)
file(GLOB web_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/web/src/*)
add_custom_command(
  OUTPUT ${page_assets_file}
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR}/web
          -DWORK=${CMAKE_CURRENT_BINARY_DIR}/web -DOUTPUT=${page_assets_file}
          "-DMISSING=${web_missing}" -DMODE=${BRICKBENCH_WEB} "-DNODE=${BRICKBENCH_NODE}"
          "-DNPM=${BRICKBENCH_NPM}" -P ${CMAKE_CURRENT_SOURCE_DIR}/web/embed.cmake
  DEPENDS ${web_sources} ${CMAKE_CURRENT_SOURCE_DIR}/web/embed.cmake
          ${CMAKE_CURRENT_SOURCE_DIR}/web/package.json
          ${CMAKE_CURRENT_SOURCE_DIR}/web/package-lock.json
  COMMENT "Report page" VERBATIM)
