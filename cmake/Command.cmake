# The motiongan command: src/**/*.cpp, one unity-build unit per folder, because compiling the headers again
# for every file takes 2.5 times as long. Use -DMOTIONGAN_UNITY=OFF while working on a single file.
file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.cpp")
find_package(CLI11 QUIET)
find_package(fmt QUIET)
find_package(PNG QUIET)
find_package(assimp QUIET)   # reads and writes FBX
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
  target_compile_definitions(motiongan-verbs PRIVATE MOTIONGAN_VERSION="${PROJECT_VERSION}"
    MOTIONGAN_WITH_ASSIMP=$<BOOL:${assimp_FOUND}>)
  if(assimp_FOUND)
    target_link_libraries(motiongan-verbs PUBLIC assimp::assimp)
  else()
    part_left_out("FBX files of the command are" libassimp-dev)
  endif()

  own_program(motiongan-command "${PROJECT_SOURCE_DIR}/src/main.cpp")
  set_target_properties(motiongan-command PROPERTIES OUTPUT_NAME motiongan)
  target_link_libraries(motiongan-command PRIVATE motiongan-verbs)
endif()
