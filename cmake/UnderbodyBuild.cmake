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

# underbody_library(NAME [USES target...] [HIDES target...])
#
# One library from all sources of the current folder and of its sub-folders that have no CMakeLists.txt of their own.
# NAME gives the target underbody_NAME and its alias underbody::NAME. USES are seen by users of the library;
# HIDES stay behind its door (their headers must not appear in public headers).
function(underbody_library name)
  cmake_parse_arguments(ARG "" "" "USES;HIDES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
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
  install(TARGETS ${target} EXPORT UnderbodyTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  foreach(header IN LISTS headers)
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/underbody/${folder})
  endforeach()
endfunction()
