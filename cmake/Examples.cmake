# Every examples/*.cpp is a program, and a test that runs it in its own folder.
file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/*.cpp")
foreach(source IN LISTS sources)
  get_filename_component(name "${source}" NAME_WE)
  set(target "example_${name}")
  own_program(${target} "${source}")
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)   # as for the tests: compiles faster, and none runs long
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples")
  if(MOTIONGAN_BUILD_TESTS)
    set(folder "${PROJECT_BINARY_DIR}/examples/run/${name}")
    file(MAKE_DIRECTORY "${folder}")
    add_test(NAME ${target} COMMAND ${target} WORKING_DIRECTORY "${folder}")
    set_tests_properties(${target} PROPERTIES LABELS examples)
  endif()
endforeach()

# Every examples/c/*.c likewise, and examples/python/*.py with the Python module; both with the models of the tests.
if(TARGET motiongan-c)
  set(arguments "${motiongan_c_models}/rnn.safetensors" run)
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/c/*.c")
  foreach(source IN LISTS sources)
    get_filename_component(name "${source}" NAME_WE)
    set(target "example_c_${name}")
    own_c_program(${target} "${source}")
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/examples")
    if(TARGET c_models)
      add_test(NAME ${target} COMMAND ${target} ${arguments})
      set_tests_properties(${target} PROPERTIES LABELS examples FIXTURES_REQUIRED c_models)
    endif()
  endforeach()
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/python/*.py")
  foreach(source IN LISTS sources)
    get_filename_component(name "${source}" NAME_WE)
    # A library with sanitizers cannot be loaded into a Python without them.
    if(TARGET c_models AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
      add_test(NAME example_python_${name} COMMAND ${CMAKE_COMMAND} "-DSCRIPT=${source}" -DNEEDS=numpy
        "-DARGUMENTS=${arguments}" -P "${PROJECT_SOURCE_DIR}/cmake/RunPython.cmake")
      set_tests_properties(example_python_${name} PROPERTIES LABELS examples
        ENVIRONMENT "${motiongan_python_environment}"
        FIXTURES_REQUIRED c_models SKIP_REGULAR_EXPRESSION "skipped:")
    endif()
  endforeach()
endif()
