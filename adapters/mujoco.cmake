# The mujoco adapter. Debian's config adds /usr/include/libqhull_r to the include directories, which
# exists only with libqhull-dev installed; the headers themselves need /usr/include alone.
brickbench_engine_option(mujoco)
if(WANTED)
  find_package(mujoco CONFIG QUIET)
  find_path(BRICKBENCH_MUJOCO_INCLUDE_DIR mujoco/mujoco.h)
  if(mujoco_FOUND AND BRICKBENCH_MUJOCO_INCLUDE_DIR)
    set_target_properties(mujoco::mujoco PROPERTIES
      IMPORTED_GLOBAL TRUE
      INTERFACE_INCLUDE_DIRECTORIES ${BRICKBENCH_MUJOCO_INCLUDE_DIR})
    brickbench_adapter(mujoco SOURCES mujoco.cpp mujoco_model.cpp LINK mujoco::mujoco)
  else()
    brickbench_engine_missing(mujoco "libmujoco-dev libopengl-dev libgl-dev")
  endif()
endif()
