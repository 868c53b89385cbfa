# The version that packaging has to repeat is VERSION.
cmake_minimum_required(VERSION 3.22)
set(file "${CMAKE_CURRENT_LIST_DIR}/../../packaging/vcpkg/ports/motiongan/vcpkg.json")
file(READ "${file}" port)
string(JSON version GET "${port}" version-semver)
if(NOT version STREQUAL VERSION)
  message(FATAL_ERROR "${file} says ${version}, CMakeLists.txt ${VERSION}")
endif()
