# Fuzz targets: every tests/fuzz/targets/*.cpp, and tests/fuzz/command/*.cpp with the code of the command.
# The ordinary test programs fuzz_replay and command_fuzz_replay run them over their seeds and regression
# inputs; with MOTIONGAN_FUZZ each is a program of its own that libFuzzer drives (./dev fuzz).
file(GLOB fuzz_targets CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/fuzz/targets/*.cpp")
file(GLOB fuzz_command_targets CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/fuzz/command/*.cpp")
list(FILTER fuzz_command_targets EXCLUDE REGEX "_test\\.cpp$")

# As one unit, because nearly all of the time is spent on the headers.
if(TARGET fuzz_replay)
  target_sources(fuzz_replay PRIVATE ${fuzz_targets})
  set_target_properties(fuzz_replay PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
endif()
if(TARGET command_fuzz_replay)
  target_sources(command_fuzz_replay PRIVATE ${fuzz_command_targets})
  target_link_libraries(command_fuzz_replay PRIVATE motiongan-verbs)
  set_target_properties(command_fuzz_replay PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
endif()

if(NOT MOTIONGAN_FUZZ)
  return()
endif()
if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  message(FATAL_ERROR "MOTIONGAN_FUZZ needs Clang. On Debian: apt-get install clang libclang-rt-14-dev")
endif()

# Sanitizers, whose every report ends the program, and coverage by line.
set(fuzz_flags -O1 -g -fno-omit-frame-pointer -fno-sanitize-recover=all
  -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fprofile-instr-generate -fcoverage-mapping)

add_library(fuzz_main OBJECT EXCLUDE_FROM_ALL "${PROJECT_SOURCE_DIR}/tests/fuzz/fuzzer.cpp")
target_link_libraries(fuzz_main PRIVATE motiongan_own)
target_compile_options(fuzz_main PRIVATE ${fuzz_flags})

function(fuzz_program source)
  get_filename_component(name "${source}" NAME_WE)
  set(target "fuzz_${name}")
  own_program(${target} "${source}")
  target_compile_options(${target} PRIVATE ${fuzz_flags})
  target_link_options(${target} PRIVATE -fsanitize=fuzzer,address,undefined -fprofile-instr-generate)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/targets")
  target_link_libraries(${target} PRIVATE fuzz_main ${ARGN})
endfunction()

foreach(source IN LISTS fuzz_targets)
  fuzz_program("${source}")
endforeach()
if(TARGET motiongan-verbs)
  # All verbs, of which only the options are used: compiled for the least time.
  target_compile_options(motiongan-verbs PRIVATE -O0 -gline-tables-only -fsanitize=fuzzer-no-link,address)
  set_target_properties(motiongan-command PROPERTIES EXCLUDE_FROM_ALL ON)   # it lacks the sanitizers' libraries
  foreach(source IN LISTS fuzz_command_targets)
    fuzz_program("${source}" motiongan-verbs)
  endforeach()
endif()
