# The motiongan command: src/**/*.cpp, one unity-build unit per folder, because compiling the headers again
# for every file takes 2.5 times as long. Use -DMOTIONGAN_UNITY=OFF while working on a single file.
file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.cpp")
find_package(CLI11 QUIET)
find_package(fmt QUIET)
find_package(PNG QUIET)
find_package(assimp QUIET)   # reads and writes FBX
find_package(MPI QUIET COMPONENTS CXX)   # trains on several machines
if(NOT CLI11_FOUND)
  part_left_out("the motiongan command and its tests are" libcli11-dev)
elseif(NOT fmt_FOUND)
  part_left_out("the motiongan command and its tests are" libfmt-dev)
elseif(NOT PNG_FOUND)
  part_left_out("the motiongan command and its tests are" libpng-dev)
elseif(sources)
  # All files but main.cpp are objects that the fuzz targets of the command link too.
  list(REMOVE_ITEM sources "${PROJECT_SOURCE_DIR}/src/main.cpp")
  add_library(motiongan-verbs OBJECT ${sources})
  set_target_properties(motiongan-verbs PROPERTIES CXX_EXTENSIONS OFF
    UNITY_BUILD ${MOTIONGAN_UNITY} UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS sources)
    get_filename_component(folder "${source}" DIRECTORY)
    get_filename_component(folder "${folder}" NAME)
    set_source_files_properties("${source}" PROPERTIES UNITY_GROUP "${folder}")
  endforeach()
  target_include_directories(motiongan-verbs PUBLIC "${PROJECT_SOURCE_DIR}/src")
  target_link_libraries(motiongan-verbs PUBLIC motiongan_own CLI11::CLI11 fmt::fmt PNG::PNG)
  target_compile_definitions(motiongan-verbs PRIVATE MOTIONGAN_WITH_ASSIMP=$<BOOL:${assimp_FOUND}>)
  if(assimp_FOUND)
    target_link_libraries(motiongan-verbs PUBLIC assimp::assimp)
  else()
    part_left_out("FBX files of the command are" libassimp-dev)
  endif()

  set_source_files_properties("${PROJECT_SOURCE_DIR}/src/shared/ranks.cpp" PROPERTIES
    COMPILE_DEFINITIONS "MOTIONGAN_WITH_MPI=$<BOOL:${MPI_CXX_FOUND}>;OMPI_SKIP_MPICXX;MPICH_SKIP_MPICXX"
    SKIP_UNITY_BUILD_INCLUSION ON)
  if(MPI_CXX_FOUND)
    target_link_libraries(motiongan-verbs PUBLIC MPI::MPI_CXX)
  else()
    part_left_out("training on several machines is" libopenmpi-dev)
  endif()

  # The page of `motiongan serve`. It is not with the pages of view/, which are part of the library.
  file(GLOB page CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/view/serve/*")
  embed_texts("${PROJECT_BINARY_DIR}/command/command/serve_page.hpp" motiongan::command::pages ${page})
  target_include_directories(motiongan-verbs PRIVATE "${PROJECT_BINARY_DIR}/command")

  # Its web server, cpp-httplib. Debian's is compiled, with the options that its header must then have as well;
  # elsewhere it is a header alone. Only http.cpp includes it.
  find_path(HTTPLIB_INCLUDE_DIR httplib.h)
  find_library(HTTPLIB_LIBRARY cpp-httplib)
  mark_as_advanced(HTTPLIB_INCLUDE_DIR HTTPLIB_LIBRARY)
  if(HTTPLIB_INCLUDE_DIR)
    set(httplib_options MOTIONGAN_HTTPLIB)
    if(HTTPLIB_LIBRARY)
      list(APPEND httplib_options CPPHTTPLIB_OPENSSL_SUPPORT CPPHTTPLIB_ZLIB_SUPPORT CPPHTTPLIB_BROTLI_SUPPORT)
      # What the header itself calls with these options.
      find_package(OpenSSL QUIET)
      target_link_libraries(motiongan-verbs PUBLIC "${HTTPLIB_LIBRARY}" $<TARGET_NAME_IF_EXISTS:OpenSSL::SSL>
        $<TARGET_NAME_IF_EXISTS:OpenSSL::Crypto>)
    endif()
    find_package(Threads REQUIRED)
    target_link_libraries(motiongan-verbs PUBLIC Threads::Threads)
    target_include_directories(motiongan-verbs SYSTEM PRIVATE "${HTTPLIB_INCLUDE_DIR}")
    set_source_files_properties("${PROJECT_SOURCE_DIR}/src/serve/http.cpp" PROPERTIES
      COMPILE_DEFINITIONS "${httplib_options}" SKIP_UNITY_BUILD_INCLUSION ON)
  else()
    part_left_out("the server of `motiongan serve` is" libcpp-httplib-dev)
  endif()

  own_program(motiongan-command "${PROJECT_SOURCE_DIR}/src/main.cpp")
  set_target_properties(motiongan-command PROPERTIES OUTPUT_NAME motiongan)
  target_link_libraries(motiongan-command PRIVATE motiongan-verbs)
endif()
