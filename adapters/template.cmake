# The template adapter: a correct toy without contact, the starting point of a new engine. Off unless
# asked for, because it is no engine to compare with.
set(BRICKBENCH_WITH_TEMPLATE OFF CACHE STRING "Build the template adapter: ON or OFF")
if(BRICKBENCH_WITH_TEMPLATE STREQUAL "ON")
  brickbench_adapter(template SOURCES template.cpp)
endif()
