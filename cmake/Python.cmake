# The Python module of packaging/python: its tests, and the target motiongan-wheel.
set(wheel_arguments "-DVERSION=${PROJECT_VERSION}" "-DLIBRARY=$<TARGET_FILE:motiongan-c>"
  "-DCOPYRIGHT=${PROJECT_BINARY_DIR}/copyright" "-DSBOM=${sbom}" "-DSTRIP=${CMAKE_STRIP}")
add_custom_target(motiongan-wheel
  COMMAND "${CMAKE_COMMAND}" ${wheel_arguments} "-DOUT=${PROJECT_BINARY_DIR}" "-DSTAGE=${PROJECT_BINARY_DIR}/wheel-files"
    -P "${PROJECT_SOURCE_DIR}/cmake/Wheel.cmake"
  COMMENT "Packing the Python wheel" VERBATIM)
add_dependencies(motiongan-wheel motiongan-c motiongan-sbom)

# A library with sanitizers cannot be loaded into a Python without them.
if(TARGET c_models AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  own_test(python_module python ${CMAKE_COMMAND} "-DSCRIPT=${PROJECT_SOURCE_DIR}/tests/python/module_test.py"
    -P "${PROJECT_SOURCE_DIR}/cmake/RunPython.cmake")
  own_test(python_wheel python ${CMAKE_COMMAND} ${wheel_arguments} "-DFOLDER=${PROJECT_BINARY_DIR}/tests/wheel"
    -P "${PROJECT_SOURCE_DIR}/tests/python/wheel.cmake")
  set_tests_properties(python_module python_wheel PROPERTIES
    ENVIRONMENT "MOTIONGAN_MODELS=${motiongan_c_models}"
    FIXTURES_REQUIRED c_models SKIP_REGULAR_EXPRESSION "skipped:")
  set_property(TEST python_module APPEND PROPERTY ENVIRONMENT ${motiongan_python_environment})
endif()
