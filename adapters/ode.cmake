# The ode adapter. ODE has no call that tells its version, so pkg-config's word is passed on.
brickbench_engine_option(ode)
if(WANTED)
  pkg_check_modules(PC_ODE QUIET IMPORTED_TARGET ode)
  if(PC_ODE_FOUND)
    brickbench_adapter(ode SOURCES ode.cpp LINK PkgConfig::PC_ODE
                       DEFINITIONS BRICKBENCH_ODE_VERSION="${PC_ODE_VERSION}")
  else()
    brickbench_engine_missing(ode libode-dev)
  endif()
endif()
