# Debian packages by cpack, one for each component of Install.cmake, and the files that only they need.
# `./dev package` sets the compiler's flags of Debian and runs it; docs/packages.md says what each package has.
set(deb_maintainer "The motiongan authors <motiongan@example.org>")
# The revision 0.1 is lower than any that Debian itself would give. Debian names a library by its SONAME.
set(deb_revision 0.1)
set(deb_version "${PROJECT_VERSION}-${deb_revision}")
set(deb_command motiongan)
set(deb_library "libmotiongan${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
set(deb_dev libmotiongan-dev)
string(TIMESTAMP deb_date "%a, %d %b %Y %H:%M:%S +0000" UTC)   # of SOURCE_DATE_EPOCH where it is set

set(deb_components "")
if(TARGET motiongan-command)
  list(APPEND deb_components command)
endif()
if(TARGET motiongan-c)
  list(APPEND deb_components library)
endif()
list(APPEND deb_components dev)

# compressed(<file> <command>...): what a command prints, as a .gz without time and name.
find_program(GZIP gzip REQUIRED)
mark_as_advanced(GZIP)
function(compressed file)
  add_custom_command(OUTPUT "${file}" COMMAND ${ARGN} | "${GZIP}" -9n > "${file}"
    DEPENDS ${compressed_depends} COMMENT "Writing ${file}" VERBATIM)
  set_property(GLOBAL APPEND PROPERTY motiongan_compressed "${file}")
endfunction()

set(deb_files "${PROJECT_BINARY_DIR}/debian")
configure_file(packaging/debian/changelog.in "${deb_files}/changelog" @ONLY)
set(compressed_depends "${deb_files}/changelog")
compressed("${deb_files}/changelog.Debian.gz" cat "${deb_files}/changelog")
set(compressed_depends "${PROJECT_SOURCE_DIR}/CHANGELOG.md")
compressed("${deb_files}/changelog.gz" cat "${PROJECT_SOURCE_DIR}/CHANGELOG.md")
if(TARGET motiongan-command)
  set(man_script "${PROJECT_SOURCE_DIR}/packaging/debian/man_page.sh")
  set(compressed_depends motiongan-command "${man_script}")
  compressed("${deb_files}/motiongan.1.gz" "${man_script}" "$<TARGET_FILE:motiongan-command>")
  install(FILES "${deb_files}/motiongan.1.gz" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT command)
endif()
get_property(compressed_files GLOBAL PROPERTY motiongan_compressed)
add_custom_target(motiongan-package-files ALL DEPENDS ${compressed_files})

foreach(component IN LISTS deb_components)
  set(deb_doc "${CMAKE_INSTALL_DATAROOTDIR}/doc/${deb_${component}}")
  install(FILES "${deb_files}/changelog.Debian.gz" "${deb_files}/changelog.gz" "${PROJECT_BINARY_DIR}/copyright" "${sbom}"
    DESTINATION "${deb_doc}" COMPONENT ${component})
endforeach()

# ---- for all packages

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${deb_maintainer}")
set(CPACK_COMPONENTS_ALL ${deb_components})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SOURCE motiongan)
set(CPACK_DEBIAN_PACKAGE_RELEASE "${deb_revision}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")   # the first line of each package's own description
set(summary "generative models of human motion over OpenCL")
set(description "motiongan trains models on captioned or labelled motion clips, and makes
new motion for a text or a class: DVGAN with CNN and RNN generators, and an
attention WGAN-GP. It runs on any OpenCL 1.2 device.")

# ---- for each

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME ${deb_command})
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_DEBIAN_COMMAND_DESCRIPTION "${summary} (command)\n${description}
\nThis package has the command: training, generation, evaluation, retargeting,
clean-up and a live page.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${deb_library})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
# ldconfig is called by a trigger. That the scripts are listed, and are no files, keeps cpack from writing them.
file(WRITE "${deb_files}/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${deb_files}/triggers;${deb_files}/postinst;${deb_files}/postrm")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "${summary} (C library)\n${description}
\nThis package has the shared library of the C interface: models, clips and
streams of characters.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME ${deb_dev})
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libclblast-dev, nlohmann-json3-dev, ocl-icd-opencl-dev, zlib1g-dev")
if(TARGET motiongan-c)
  set(CPACK_COMPONENT_DEV_DEPENDS library)
endif()
set(CPACK_DEBIAN_DEV_DESCRIPTION "${summary} (development)\n${description}
\nThis package has the headers of the C++ library and of the C interface, and
files for CMake and pkg-config.")

include(CPack)
