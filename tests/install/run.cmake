# Installs the build in BUILD_DIR below itself, then configures, builds and runs the consumer against that.
set(prefix "${BUILD_DIR}/install-test/prefix")
set(consumer "${BUILD_DIR}/install-test/consumer")
file(REMOVE_RECURSE "${BUILD_DIR}/install-test")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " line)
    message(FATAL_ERROR "failed (${result}): ${line}")
  endif()
endfunction()

run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${prefix}")
run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${consumer}" -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${prefix}"
  "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DCMAKE_C_COMPILER=${CC}" "-DWITH_C=${WITH_C}"
  -DCMAKE_BUILD_TYPE=Debug --no-warn-unused-cli)
run("${CMAKE_COMMAND}" --build "${consumer}")
run("${consumer}/consumer")
if(WITH_C)
  run("${consumer}/consumer_c")
endif()

# The same programs by pkg-config, which finds the files where they were installed.
find_program(PKG_CONFIG NAMES pkg-config pkgconf)
if(NOT PKG_CONFIG)
  message("the part of pkg-config was left out: there is no pkg-config")
  return()
endif()
file(GLOB_RECURSE pkgconfig_file "${prefix}/motiongan.pc")
get_filename_component(pkgconfig_dir "${pkgconfig_file}" DIRECTORY)
get_filename_component(library_dir "${pkgconfig_dir}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${pkgconfig_dir}")

# flags_of(<variable> <option>... <name>): what pkg-config answers, as a list.
function(flags_of variable)
  execute_process(COMMAND "${PKG_CONFIG}" ${ARGN} OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  set(${variable} ${flags} PARENT_SCOPE)
endfunction()

flags_of(version --modversion motiongan)
flags_of(flags --cflags --libs motiongan)
run(${LAUNCHER} "${CXX}" -std=c++20 "-DFOUND_VERSION=\"${version}\"" "${SOURCE_DIR}/consumer.cpp"
  -o "${consumer}/by_pkg_config" ${flags})
run("${consumer}/by_pkg_config")
if(WITH_C)
  flags_of(flags --cflags --libs motiongan-c)
  run("${CC}" -std=c11 "${SOURCE_DIR}/consumer.c" -o "${consumer}/by_pkg_config_c" ${flags} "-Wl,-rpath,${library_dir}")
  run("${consumer}/by_pkg_config_c")
endif()
