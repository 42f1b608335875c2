# How every target of the project is made.
include(GNUInstallDirs)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
endif()
find_program(MOLD mold)
if(MOLD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_link_options(-fuse-ld=mold)
endif()

add_library(underbody_options INTERFACE)
target_compile_options(underbody_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
if(UNDERBODY_SANITIZE)
  target_compile_options(underbody_options INTERFACE -fsanitize=${UNDERBODY_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(underbody_options INTERFACE -fsanitize=${UNDERBODY_SANITIZE})
endif()
if(UNDERBODY_ASSERTIONS)
  target_compile_options(underbody_options INTERFACE -UNDEBUG -D_GLIBCXX_ASSERTIONS)
endif()

# What most sources include, parsed once for all targets. Off in the presets for writing code: a compiler cache cannot
# keep what was compiled with it.
if(UNDERBODY_PRECOMPILE)
  file(WRITE ${CMAKE_BINARY_DIR}/precompiled.cpp "")
  add_library(underbody_precompiled STATIC ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(underbody_precompiled PRIVATE underbody_options)
  target_precompile_headers(underbody_precompiled PRIVATE
    <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex>
    <numbers> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <unordered_map> <utility> <vector>
    <nlohmann/json.hpp>)
endif()

# underbody_precompile(TARGET): the target takes the headers precompiled above.
function(underbody_precompile target)
  if(UNDERBODY_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM underbody_precompiled)
  endif()
endfunction()

# underbody_optimise_hard(FILE...): sources whose speed the benchmarks show; they are compiled by themselves.
function(underbody_optimise_hard)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>"
    SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

# underbody_optimise_less(TARGET): for what calls the libraries and computes little itself. -O1 compiles it in three
# quarters of the time (units of the window, the commands and the studies: 0.65 to 0.78).
function(underbody_optimise_less target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  # So optimised, GCC 12 warns of what std::string and std::to_string do themselves.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-maybe-uninitialized -Wno-stringop-overflow)
  endif()
endfunction()

# underbody_units(TARGET SOURCE...): compiles several sources as one unit where CMAKE_UNITY_BUILD is on (preset release):
# most of the time of a small source goes into headers and templates that its neighbours share. UNDERBODY_UNIT_HEADERS:
# the headers of sources that lie in another folder.
function(underbody_units target)
  if(CMAKE_UNITY_BUILD)
    file(GLOB_RECURSE headers RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.h ${UNDERBODY_UNIT_HEADERS})
    execute_process(COMMAND awk -v most=${CMAKE_UNITY_BUILD_BATCH_SIZE} -f ${CMAKE_SOURCE_DIR}/cmake/unity_groups.awk ${headers} ${ARGN}
      WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE groups COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX MATCHALL "[0-9]+" groups "${groups}")
    foreach(source group IN ZIP_LISTS ARGN groups)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endforeach()
    set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
    # What only one file would be warned of is checked by the presets that compile file by file.
    target_compile_options(${target} PRIVATE -Wno-shadow -Wno-subobject-linkage)
  endif()
endfunction()

# Libraries whose branches tests/coverage counts.
set(UNDERBODY_COUNTED cases estimator)

# underbody_library(NAME [USES target...] [HIDES target...])
#
# One library from all sources of the current folder and of its sub-folders that have no CMakeLists.txt of their own.
# NAME gives the target underbody_NAME and its alias underbody::NAME. USES are seen by users of the library;
# HIDES stay behind its door (their headers must not appear in public headers).
# What is installed of its headers: those in cmake/public_headers.txt, which include none that is not there.
function(underbody_library name)
  cmake_parse_arguments(ARG "" "" "USES;HIDES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  if(NOT sources)
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/empty.cpp "")
    set(sources ${CMAKE_CURRENT_BINARY_DIR}/empty.cpp)
  endif()
  set(target underbody_${name})
  add_library(${target} STATIC ${sources})
  add_library(underbody::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/underbody>)
  target_link_libraries(${target} PUBLIC ${ARG_USES} PRIVATE $<BUILD_INTERFACE:underbody_options>)
  foreach(hidden IN LISTS ARG_HIDES)
    target_link_libraries(${target} PRIVATE ${hidden})
  endforeach()
  underbody_precompile(${target})
  underbody_units(${target} ${sources})
  # For tests/coverage: the same sources with their branches counted, which mean decisions only where nothing is
  # optimised away. Headers precompiled for -O2 do not fit.
  if(name IN_LIST UNDERBODY_COUNTED)
    add_library(${target}_counted OBJECT EXCLUDE_FROM_ALL ${sources})
    target_link_libraries(${target}_counted PRIVATE ${target} ${ARG_HIDES} underbody_options)
    target_compile_options(${target}_counted PRIVATE -O0 --coverage)
    underbody_units(${target}_counted ${sources})
  endif()
  install(TARGETS ${target} EXPORT UnderbodyTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  file(RELATIVE_PATH room ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/public_headers.txt)
  file(STRINGS ${CMAKE_SOURCE_DIR}/cmake/public_headers.txt headers REGEX "^${room}/")
  foreach(header IN LISTS headers)
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/underbody/${folder}
      COMPONENT development)
  endforeach()
endfunction()
