# brickbench_adapter(NAME SOURCES ... LINK ... [DEFINITIONS ...])
#
# Adds the adapter library `adapter_NAME` and lists it: the catalogue of engines is generated from
# these calls, so what is linked is listed and what is listed is linked. The one public symbol of an
# adapter is `brickbench::Adapter brickbench::NAME_adapter()`.
#
# Whether NAME is built follows BRICKBENCH_WITH_<NAME> = AUTO | ON | OFF. The caller looks for the
# engine between brickbench_engine_option() and brickbench_adapter().
set_property(GLOBAL PROPERTY BRICKBENCH_ADAPTERS "")
# Every engine that has an option, and "name:packages" of those that were looked for in vain.
set_property(GLOBAL PROPERTY BRICKBENCH_ENGINES_KNOWN "")
set_property(GLOBAL PROPERTY BRICKBENCH_ENGINES_MISSING "")

# brickbench_engine_option(NAME): defines BRICKBENCH_WITH_<NAME>; sets WANTED to whether to look for it.
function(brickbench_engine_option name)
  string(TOUPPER ${name} upper)
  set(BRICKBENCH_WITH_${upper} AUTO CACHE STRING "Build the ${name} adapter: AUTO, ON or OFF")
  set_property(CACHE BRICKBENCH_WITH_${upper} PROPERTY STRINGS AUTO ON OFF)
  set_property(GLOBAL APPEND PROPERTY BRICKBENCH_ENGINES_KNOWN ${name})
  if(BRICKBENCH_WITH_${upper} STREQUAL "OFF")
    set(WANTED FALSE PARENT_SCOPE)
    message(STATUS "brickbench: engine ${name} switched off (BRICKBENCH_WITH_${upper}=OFF)")
  else()
    set(WANTED TRUE PARENT_SCOPE)
  endif()
endfunction()

# brickbench_engine_missing(NAME PACKAGES): a status line under AUTO, an error under ON.
function(brickbench_engine_missing name packages)
  string(TOUPPER ${name} upper)
  if(BRICKBENCH_WITH_${upper} STREQUAL "ON")
    message(FATAL_ERROR "brickbench: engine ${name} not found; install ${packages}")
  endif()
  set_property(GLOBAL APPEND PROPERTY BRICKBENCH_ENGINES_MISSING "${name}:${packages}")
  message(STATUS "brickbench: engine ${name} not found, skipped; install ${packages} to have it")
endfunction()

function(brickbench_adapter name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;DEFINITIONS" ${ARGN})
  add_library(adapter_${name} STATIC ${ARG_SOURCES})
  brickbench_headers_of(adapter_${name} brickbench_headers)
  target_link_libraries(adapter_${name} PUBLIC brickbench_seam PRIVATE ${ARG_LINK})
  target_compile_definitions(adapter_${name} PRIVATE ${ARG_DEFINITIONS})
  set_property(GLOBAL APPEND PROPERTY BRICKBENCH_ADAPTERS ${name})
  message(STATUS "brickbench: engine ${name} enabled")
endfunction()

# brickbench_adapter_catalog(): writes and builds the generated catalogue, after all adapters.
function(brickbench_adapter_catalog)
  get_property(names GLOBAL PROPERTY BRICKBENCH_ADAPTERS)
  set(declarations "")
  set(entries "")
  set(libraries "")
  foreach(name IN LISTS names)
    string(APPEND declarations "Adapter ${name}_adapter();\n")
    string(APPEND entries "${name}_adapter(), ")
    list(APPEND libraries adapter_${name})
  endforeach()
  set(file ${CMAKE_CURRENT_BINARY_DIR}/catalog.cpp)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[
// Generated from the enabled adapter targets (cmake/Adapter.cmake).
#include "adapters/catalog.hpp"

namespace brickbench {

@declarations@
std::vector<Adapter> adapters() { return {@entries@}; }

}  // namespace brickbench
]])
  add_library(brickbench_adapters STATIC ${file})
  target_link_libraries(brickbench_adapters PUBLIC brickbench_seam PRIVATE ${libraries})
endfunction()
