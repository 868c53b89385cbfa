# libmotiongan: include/motiongan.h over the headers, from c/*.cpp, compiled as one unit as the command is.
file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/c/*.cpp")
set(exports "${PROJECT_SOURCE_DIR}/c/exports.map")
add_library(motiongan-c SHARED ${sources})
add_library(motiongan::c ALIAS motiongan-c)
target_link_libraries(motiongan-c PRIVATE motiongan_own)
target_include_directories(motiongan-c INTERFACE
  "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>"
  "$<BUILD_INTERFACE:${motiongan_generated}>"
  "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
# Before 1.0 a minor version may change the interface, as the CMake package says too.
set_target_properties(motiongan-c PROPERTIES
  EXPORT_NAME c OUTPUT_NAME motiongan
  VERSION "${PROJECT_VERSION}" SOVERSION "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}"
  CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
  UNITY_BUILD ${MOTIONGAN_UNITY} UNITY_BUILD_BATCH_SIZE 0
  LINK_DEPENDS "${exports}")
# What a Python needs to find the module, and the module the library.
set(motiongan_python_environment
  "PYTHONPATH=${PROJECT_SOURCE_DIR}/packaging/python" "MOTIONGAN_LIBRARY=$<TARGET_FILE:motiongan-c>" PYTHONDONTWRITEBYTECODE=1)
# nodelete: OpenCL drivers keep threads, and calls at the end of the process, that must find the library.
target_link_options(motiongan-c PRIVATE "LINKER:--version-script=${exports}" "LINKER:-z,nodelete")
