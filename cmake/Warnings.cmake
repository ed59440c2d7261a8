# brickbench_options: what every target of ours is compiled with.
#
# -ffp-contract=off: a fused multiply-add rounds once where the source says twice, so results would
# depend on the compiler's mood and on the machine; state hashes must not.
add_library(brickbench_options INTERFACE)
target_compile_options(brickbench_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -ffp-contract=off
  $<$<BOOL:${BRICKBENCH_WERROR}>:-Werror>)
target_include_directories(brickbench_options INTERFACE ${PROJECT_SOURCE_DIR})
if(BRICKBENCH_SANITIZE)
  # Null pointers trap and strays are seen by the address sanitizer without `null` and
  # `pointer-overflow`; no cast here needs `vptr`. Without the three the build takes a third less.
  target_compile_options(brickbench_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize=null,vptr,pointer-overflow
    -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(brickbench_options INTERFACE -fsanitize=address,undefined)
endif()

function(brickbench_light_options target)
  if(BRICKBENCH_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  else()
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# brickbench_light(TARGET): no inner loop runs in it, so it is optimised little and built soon.
function(brickbench_light target)
  brickbench_light_options(${target})
  brickbench_headers_of(${target} brickbench_headers_light)
endfunction()

# The presets that are built once and whole set it; while one file is edited, files are better alone.
option(BRICKBENCH_TOGETHER "Compile the files of some targets together: half the time of a whole build" OFF)

# brickbench_together(TARGET): its files may be compiled a few at a time as one, so that headers are
# read once. Names in the unnamed namespaces of these files must differ. Not for rooms to which
# people add a file of the same shape (engines, scenes, metrics, cases), nor for inner loops.
function(brickbench_together target)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${BRICKBENCH_TOGETHER} UNITY_BUILD_BATCH_SIZE 6)
endfunction()
