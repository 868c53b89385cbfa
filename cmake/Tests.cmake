# Every tests/ROOM/NAME_test.cpp is the test ROOM_NAME. The files of a room are one program, and a test runs the
# cases of its file in a process of its own.
find_package(doctest QUIET)
if(NOT doctest_FOUND)
  part_left_out("the tests are" doctest-dev)
  return()
endif()

# An object library, because the linker may drop main() from a static library.
add_library(test_main OBJECT "${PROJECT_SOURCE_DIR}/tests/main.cpp")
target_link_libraries(test_main PUBLIC doctest::doctest PRIVATE motiongan)

# own_test(<name> <label> <command>...): registers a test with the label.
function(own_test name label)
  add_test(NAME ${name} COMMAND ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS ${label})
endfunction()

# room_test(<test> <label> <room> <name>): registers the cases of one file of a room.
function(room_test test label room name)
  own_test(${test} ${label} test_${room} "--source-file=*/${room}/${name}_test.cpp")
endfunction()

# test_program(<target> <room> <source>...): a program of tests.
function(test_program target room)
  own_program(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE test_main)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)   # compiles in three quarters of the time, and none runs long
  target_compile_definitions(${target} PRIVATE MOTIONGAN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # Nearly all of the time is spent on the headers: seven files compile in the time of two.
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests"
    UNITY_BUILD ${MOTIONGAN_UNITY} UNITY_BUILD_BATCH_SIZE 7)
  if(room STREQUAL "c")
    target_link_libraries(${target} PRIVATE motiongan::c)
  elseif(room STREQUAL "command")
    add_dependencies(${target} motiongan-command)
    target_compile_definitions(${target} PRIVATE MOTIONGAN_COMMAND="$<TARGET_FILE:motiongan-command>")
  endif()
endfunction()

# Programs of their own: they define functions of OpenCL, or change what a header says.
set(alone core_build_failure core_failing_driver)
file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/*_test.cpp")
set(rooms)
foreach(source IN LISTS sources)
  get_filename_component(name "${source}" NAME_WE)
  string(REGEX REPLACE "_test$" "" name "${name}")
  get_filename_component(folder "${source}" DIRECTORY)
  get_filename_component(room "${folder}" NAME)
  if((room STREQUAL "command" AND NOT TARGET motiongan-command) OR (room STREQUAL "c" AND NOT TARGET motiongan-c))
    continue()
  endif()
  set(test "${room}_${name}")
  if(test IN_LIST alone OR folder MATCHES "/fuzz")
    test_program(${test} ${room} "${source}")
    own_test(${test} ${room} ${test})
  else()
    list(APPEND rooms ${room})
    list(APPEND sources_of_${room} "${source}")
    room_test(${test} ${room} ${room} ${name})
  endif()
endforeach()
list(REMOVE_DUPLICATES rooms)
foreach(room IN LISTS rooms)
  test_program(test_${room} ${room} ${sources_of_${room}})
endforeach()

# Suites whose kernels have a wide form (docs/devices.md) run in it too, whatever the device.
foreach(name core_gemm golden_golden networks_attention_rollout networks_rnn_stream ops_attention ops_derivatives ops_empty
    optim_sgd search_distance)
  string(REGEX MATCH "^([a-z]+)_(.*)$" matched ${name})
  room_test(${name}_wide wide ${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
  set_tests_properties(${name}_wide PROPERTIES ENVIRONMENT MOTIONGAN_KERNELS=wide)
endforeach()

# The C interface as programs in C use it, with models that c_models writes for them and for the examples.
if(TARGET motiongan-c)
  set(motiongan_c_models "${PROJECT_BINARY_DIR}/tests/c-models")
  own_program(c_models "${PROJECT_SOURCE_DIR}/tests/c/models.cpp")
  set_target_properties(c_models PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  own_test(c_models c c_models "${motiongan_c_models}")
  set_tests_properties(c_models PROPERTIES FIXTURES_SETUP c_models)
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/c/*_test.c")
  foreach(source IN LISTS sources)
    get_filename_component(name "${source}" NAME_WE)
    string(REGEX REPLACE "_test$" "" name "${name}")
    own_c_program(c_${name} "${source}")
    set_target_properties(c_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
    own_test(c_${name} c c_${name} "${motiongan_c_models}")
    set_tests_properties(c_${name} PROPERTIES FIXTURES_REQUIRED c_models)
  endforeach()
  own_test(c_exports c ${CMAKE_COMMAND} "-DLIBRARY=$<TARGET_FILE:motiongan-c>"
    "-DHEADER=${PROJECT_SOURCE_DIR}/include/motiongan.h" "-DNM=${CMAKE_NM}"
    -P "${PROJECT_SOURCE_DIR}/tests/c/exports.cmake")
  set_tests_properties(c_exports PROPERTIES SKIP_REGULAR_EXPRESSION "skipped:")
endif()

# Two translation units that include the whole library: a function without `inline` fails to link.
file(GLOB umbrella CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/motiongan.hpp")
if(umbrella)
  own_program(second_unit "${PROJECT_SOURCE_DIR}/tests/second_unit.cpp" "${PROJECT_SOURCE_DIR}/tests/second_unit_main.cpp")
  set_target_properties(second_unit PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  own_test(second_unit tests second_unit)

  # A separate project, built against an install tree.
  set(with_c OFF)
  if(TARGET motiongan-c AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    set(with_c ON)
  endif()
  own_test(install_consumer install ${CMAKE_COMMAND}
    "-DBUILD_DIR=${PROJECT_BINARY_DIR}" "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}/tests/install"
    "-DGENERATOR=${CMAKE_GENERATOR}" "-DCXX=${CMAKE_CXX_COMPILER}" "-DLAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}"
    "-DCC=${CMAKE_C_COMPILER}" "-DWITH_C=${with_c}"
    -P "${PROJECT_SOURCE_DIR}/tests/install/run.cmake")
endif()

# motiongan-golden FILE...: compares the models with reference files written by PyTorch.
file(GLOB golden CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/golden/golden.cpp")
if(golden)
  own_program(motiongan-golden ${golden})
endif()
