// Facts of the build, written by revision.cmake at each build.
#pragma once

namespace brickbench {

const char* source_revision();
const char* build_compiler();
const char* build_flags();
const char* build_type();

}  // namespace brickbench
