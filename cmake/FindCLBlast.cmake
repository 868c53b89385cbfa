# Finds CLBlast by its header and library and defines CLBlast::CLBlast. CLBlast's own package file requires
# one exact library version and build type; this module works with and without it.
find_path(CLBlast_INCLUDE_DIR clblast.h)
find_library(CLBlast_LIBRARY clblast)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CLBlast REQUIRED_VARS CLBlast_LIBRARY CLBlast_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libclblast-dev")
mark_as_advanced(CLBlast_INCLUDE_DIR CLBlast_LIBRARY)
if(CLBlast_FOUND AND NOT TARGET CLBlast::CLBlast)
  add_library(CLBlast::CLBlast UNKNOWN IMPORTED)
  set_target_properties(CLBlast::CLBlast PROPERTIES
    IMPORTED_LOCATION "${CLBlast_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CLBlast_INCLUDE_DIR}")
endif()
