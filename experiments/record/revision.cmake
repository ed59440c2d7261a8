# cmake -DSOURCE=... -DOUTPUT=... -DCOMPILER=... -DFLAGS=... -DBUILD_TYPE=... -P revision.cmake
#
# Writes OUTPUT, a source file with the revision of the working tree; the file is touched only when
# something in it has changed, so that a build with nothing new compiles nothing.
set(REVISION "unknown")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --short=12 HEAD
                  OUTPUT_VARIABLE head OUTPUT_STRIP_TRAILING_WHITESPACE
                  RESULT_VARIABLE status ERROR_QUIET)
  if(status EQUAL 0)
    execute_process(COMMAND ${GIT} -C ${SOURCE} diff HEAD OUTPUT_VARIABLE changes ERROR_QUIET)
    set(REVISION ${head})
    if(NOT changes STREQUAL "")
      string(SHA1 digest "${changes}")
      string(SUBSTRING ${digest} 0 8 digest)
      string(APPEND REVISION "-dirty.${digest}")
    endif()
  endif()
endif()
string(STRIP "${FLAGS}" FLAGS)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
// Written by experiments/record/revision.cmake.
#include "experiments/record/revision.hpp"

namespace brickbench {

const char* source_revision() { return "@REVISION@"; }
const char* build_compiler() { return "@COMPILER@"; }
const char* build_flags() { return "@FLAGS@"; }
const char* build_type() { return "@BUILD_TYPE@"; }

}  // namespace brickbench
]])
