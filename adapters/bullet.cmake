# The bullet adapter. Debian's double build is known to pkg-config alone: FindBullet finds the float
# libraries, whose symbols clash with the double ones. The prefix must not be BULLET (other packages
# read BULLET_* from the cache).
brickbench_engine_option(bullet)
if(WANTED)
  pkg_check_modules(PC_BULLET QUIET IMPORTED_TARGET bullet-float64)
  if(PC_BULLET_FOUND)
    brickbench_adapter(bullet SOURCES bullet.cpp LINK PkgConfig::PC_BULLET)
  else()
    brickbench_engine_missing(bullet libbullet-dev)
  endif()
endif()
