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
  # Null pointers trap without the check that `null` puts before each access; no cast here needs
  # `vptr`. Without the two the build takes a third less.
  target_compile_options(brickbench_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize=null,vptr -fno-sanitize-recover=undefined
    -fno-omit-frame-pointer)
  target_link_options(brickbench_options INTERFACE -fsanitize=address,undefined)
endif()
