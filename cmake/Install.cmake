# What `cmake --install` installs, in three components, each of which is a package (Packages.cmake):
# command, library (the C interface as programs need it) and dev (all that programs are compiled with).
set(motiongan_cmake_dir "${CMAKE_INSTALL_LIBDIR}/cmake/motiongan")

if(TARGET motiongan-command)
  install(TARGETS motiongan-command RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT command)
endif()

# The shipped models, found by name: beside the command in the build folder, in share/ once installed.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/models/" DESTINATION "${CMAKE_INSTALL_DATADIR}/motiongan/models" COMPONENT command
  FILES_MATCHING PATTERN "*.safetensors" PATTERN "*.md" PATTERN "SHA256SUMS")
file(CREATE_LINK "${PROJECT_SOURCE_DIR}/models" "${PROJECT_BINARY_DIR}/models" SYMBOLIC)

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev
  FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY "${motiongan_generated}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
install(TARGETS motiongan EXPORT motiongan-targets)
if(TARGET motiongan-c)
  install(FILES "${PROJECT_SOURCE_DIR}/include/motiongan.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev)
  install(TARGETS motiongan-c EXPORT motiongan-targets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT dev)
endif()

# find_package(motiongan)
install(EXPORT motiongan-targets NAMESPACE motiongan:: DESTINATION "${motiongan_cmake_dir}" COMPONENT dev)
configure_package_config_file(cmake/motiongan-config.cmake.in "${PROJECT_BINARY_DIR}/motiongan-config.cmake"
  INSTALL_DESTINATION "${motiongan_cmake_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/motiongan-config-version.cmake"
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES
  "${PROJECT_BINARY_DIR}/motiongan-config.cmake"
  "${PROJECT_BINARY_DIR}/motiongan-config-version.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindCLBlast.cmake"
  DESTINATION "${motiongan_cmake_dir}" COMPONENT dev)

# pkg-config; the files find the prefix from where they are.
set(pkgconfig_dir "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig")
file(RELATIVE_PATH pkgconfig_prefix "${pkgconfig_dir}" "${CMAKE_INSTALL_PREFIX}")
string(REGEX REPLACE "/$" "" pkgconfig_prefix "${pkgconfig_prefix}")
file(RELATIVE_PATH pkgconfig_include "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
file(RELATIVE_PATH pkgconfig_lib "${CMAKE_INSTALL_PREFIX}" "${CMAKE_INSTALL_FULL_LIBDIR}")
set(pkgconfig_names motiongan)
if(TARGET motiongan-c)
  list(APPEND pkgconfig_names motiongan-c)
endif()
foreach(name IN LISTS pkgconfig_names)
  configure_file("cmake/${name}.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT dev)
endforeach()
