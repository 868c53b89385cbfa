# Packs the Python module of packaging/python with LIBRARY, the shipped models, COPYRIGHT and SBOM as a wheel of VERSION into OUT.
# Works in the folder STAGE; STRIP, where given, strips the library. Says "skipped" where the Python tools are missing.
cmake_minimum_required(VERSION 3.22)
include("${CMAKE_CURRENT_LIST_DIR}/PythonWith.cmake")
python_with(PYTHON setuptools wheel pip)   # Debian's pip must not be imported before setuptools
if(NOT PYTHON)
  return()
endif()
set(source "${CMAKE_CURRENT_LIST_DIR}/../packaging/python")
file(REMOVE_RECURSE "${STAGE}")
file(GLOB module "${source}/motiongan/*.py")
file(COPY ${module} "${SBOM}" DESTINATION "${STAGE}/motiongan")
file(COPY "${source}/../../models" DESTINATION "${STAGE}/motiongan")
file(COPY "${COPYRIGHT}" DESTINATION "${STAGE}")
configure_file("${LIBRARY}" "${STAGE}/motiongan/libmotiongan.so" COPYONLY)   # the file, where LIBRARY is a link
if(STRIP)
  execute_process(COMMAND "${STRIP}" --strip-unneeded "${STAGE}/motiongan/libmotiongan.so" COMMAND_ERROR_IS_FATAL ANY)
endif()
execute_process(COMMAND "${PYTHON}" -c "import sysconfig; print(sysconfig.get_platform().replace('-', '_'))"
  OUTPUT_VARIABLE PLATFORM OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
configure_file("${source}/pyproject.toml.in" "${STAGE}/pyproject.toml" @ONLY)
execute_process(COMMAND "${PYTHON}" -m pip wheel --quiet --disable-pip-version-check --no-index --no-deps
  --no-build-isolation --wheel-dir "${OUT}" "${STAGE}" RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the wheel could not be built (${result})")
endif()
