# TlExpected::TlExpected, a header alone: Debian's tl::expected brings no CMake package.
find_path(TLEXPECTED_INCLUDE_DIR tl/expected.hpp)
mark_as_advanced(TLEXPECTED_INCLUDE_DIR)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(TlExpected REQUIRED_VARS TLEXPECTED_INCLUDE_DIR)
if(TlExpected_FOUND AND NOT TARGET TlExpected::TlExpected)
  add_library(TlExpected::TlExpected INTERFACE IMPORTED GLOBAL)
  target_include_directories(TlExpected::TlExpected SYSTEM INTERFACE ${TLEXPECTED_INCLUDE_DIR})
endif()
