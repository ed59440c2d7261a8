# The ourengine adapter: the engine of this project, always found.
brickbench_engine_option(ourengine)
if(WANTED)
  brickbench_adapter(ourengine SOURCES ourengine.cpp ourengine_baraff.cpp ourengine_velocity.cpp
                     LINK ourengine)
endif()
