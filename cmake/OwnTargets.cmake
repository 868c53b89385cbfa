# What every program of this project shares. None of it reaches those who use the library.

add_library(motiongan_own INTERFACE)
target_link_libraries(motiongan_own INTERFACE motiongan)
# (GCC 12 takes an empty std::optional for an uninitialised value, now here, now there, as it inlines.)
target_compile_options(motiongan_own INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized> $<$<BOOL:${MOTIONGAN_WERROR}>:-Werror>)

# own_program(<target> <source>...): an executable of this project.
function(own_program target)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE motiongan_own)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()

# part_left_out(<part> <package>): says why a part is not built, and what would help.
function(part_left_out part package)
  message(STATUS "motiongan: ${part} left out; on Debian they need: apt-get install ${package}")
endfunction()
