# Builds the wheel in FOLDER as Wheel.cmake says, installs it into another folder, and runs the module's test with that.
cmake_minimum_required(VERSION 3.22)
set(OUT "${FOLDER}/wheel")
set(STAGE "${FOLDER}/stage")
file(REMOVE_RECURSE "${FOLDER}")
include("${CMAKE_CURRENT_LIST_DIR}/../../cmake/Wheel.cmake")
if(NOT PYTHON)
  return()
endif()
file(GLOB wheel "${OUT}/motiongan-${VERSION}-py3-none-*.whl")
execute_process(COMMAND "${PYTHON}" -m pip install --quiet --disable-pip-version-check --no-index --no-deps
  --target "${FOLDER}/site" "${wheel}" COMMAND_ERROR_IS_FATAL ANY)
set(ENV{PYTHONPATH} "${FOLDER}/site")
execute_process(COMMAND "${PYTHON}" "${CMAKE_CURRENT_LIST_DIR}/module_test.py" COMMAND_ERROR_IS_FATAL ANY)
