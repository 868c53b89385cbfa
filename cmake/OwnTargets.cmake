# Settings shared by the programs of this project. They do not propagate to users of the library.

add_library(motiongan_own INTERFACE)
target_link_libraries(motiongan_own INTERFACE motiongan)
# GCC 12 reports false positives of -Wmaybe-uninitialized for an empty std::optional, depending on inlining. Clang 19
# calls what std::stable_sort() of GCC 12's library uses deprecated.
target_compile_options(motiongan_own INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized> $<$<BOOL:${MOTIONGAN_WERROR}>:-Werror>
  $<$<CXX_COMPILER_ID:Clang>:-Wno-error=deprecated-declarations>)

# own_program(<target> <source>...): an executable of this project.
function(own_program target)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE motiongan_own)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()

# own_c_program(<target> <source>...): a program in C11 of this project, which uses the C interface.
function(own_c_program target)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE motiongan::c)
  set_target_properties(${target} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    $<$<BOOL:${MOTIONGAN_WERROR}>:-Werror>)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=[^ ]+")   # the library's sanitizers have to be the program's
    target_compile_options(${target} PRIVATE ${CMAKE_MATCH_0})
    target_link_options(${target} PRIVATE ${CMAKE_MATCH_0})
  endif()
endfunction()

# part_left_out(<part> <package>): reports a part that is not built and the package that it needs.
function(part_left_out part package)
  message(STATUS "motiongan: ${part} not built: ${package} is missing; on Debian: apt-get install ${package}")
endfunction()
