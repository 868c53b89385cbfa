# The licences, and a bill of materials, of what is built: share/doc/motiongan, or the folder of each package.
file(READ LICENSE licence_text)
string(REGEX REPLACE "^.*authors\n\n" "" licence_text "${licence_text}")   # the permission, after title and holder
string(STRIP "${licence_text}" licence_text)
string(REPLACE "\n\n" "\n.\n" licence_text "${licence_text}")
string(REPLACE "\n" "\n " licence_text "${licence_text}")
configure_file(packaging/copyright.in "${PROJECT_BINARY_DIR}/copyright" @ONLY)

set(sbom "${PROJECT_BINARY_DIR}/motiongan.spdx.json")
set(sbom_targets "")
set(sbom_compiled_in "")
if(TARGET motiongan-command)
  list(APPEND sbom_targets motiongan-command)
  list(APPEND sbom_compiled_in "CLI11|${CLI11_VERSION}|BSD-3-Clause")
endif()
if(TARGET motiongan-c)
  list(APPEND sbom_targets motiongan-c)
endif()
if(sbom_targets)
  list(APPEND sbom_compiled_in "nlohmann-json|${nlohmann_json_VERSION}|MIT")
endif()
if(HTTPLIB_INCLUDE_DIR AND NOT HTTPLIB_LIBRARY)
  file(STRINGS "${HTTPLIB_INCLUDE_DIR}/httplib.h" httplib_version REGEX "define CPPHTTPLIB_VERSION \"")
  string(REGEX REPLACE ".*\"([^\"]*)\".*" "\\1" httplib_version "${httplib_version}")
  list(APPEND sbom_compiled_in "cpp-httplib|${httplib_version}|MIT")
endif()
list(TRANSFORM sbom_targets REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE sbom_binaries)
add_custom_command(OUTPUT "${sbom}"
  COMMAND "${CMAKE_COMMAND}" "-DOUT=${sbom}" "-DVERSION=${PROJECT_VERSION}" -DLICENCE=MIT
    "-DCOMPILED_IN=${sbom_compiled_in}" "-DBINARIES=${sbom_binaries}" "-DREADELF=${CMAKE_READELF}"
    "-DLIBRARY_ARCHITECTURE=${CMAKE_LIBRARY_ARCHITECTURE}" -P "${PROJECT_SOURCE_DIR}/cmake/Sbom.cmake"
  DEPENDS ${sbom_targets} cmake/Sbom.cmake COMMENT "Writing motiongan.spdx.json" VERBATIM)
add_custom_target(motiongan-sbom ALL DEPENDS "${sbom}")
if(NOT MOTIONGAN_PACKAGE)   # else Packages.cmake installs them with each package
  install(FILES "${PROJECT_BINARY_DIR}/copyright" "${sbom}" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT command)
endif()
if(COMMAND own_test)
  own_test(packages_versions packages ${CMAKE_COMMAND} "-DVERSION=${PROJECT_VERSION}"
    -P "${PROJECT_SOURCE_DIR}/tests/packages/versions.cmake")
endif()
if(COMMAND own_test AND sbom_targets)
  own_test(packages_sbom packages ${CMAKE_COMMAND} "-DSBOM=${sbom}" "-DVERSION=${PROJECT_VERSION}"
    -P "${PROJECT_SOURCE_DIR}/tests/packages/sbom.cmake")
endif()
