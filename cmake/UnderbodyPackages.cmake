# Debian packages of what was built: `cpack -G DEB` in the build folder. One package a component:
#   program      underbody             the command line, its manual and completion
#   studio       underbody-studio      the desktop
#   development  libunderbody-dev      libraries, headers and the CMake package
#   python       python3-underbody     the Python module
# Two runs give equal bytes: dates are those of the last commit (SOURCE_DATE_EPOCH).
if(NOT UNDERBODY_BUILD_STUDIO)
  return()
endif()
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
find_package(Git QUIET)

set(package_folder ${CMAKE_CURRENT_BINARY_DIR}/packages)
set(package_components program studio development)
if(TARGET underbody_python)
  list(APPEND package_components python)
endif()
set(package_name_program underbody)
set(package_name_studio underbody-studio)
set(package_name_development libunderbody-dev)
set(package_name_python python3-underbody)

# What Debian wants with every package: the licence and the changes, compressed without a date.
foreach(component IN LISTS package_components)
  set(name ${package_name_${component}})
  set(folder ${package_folder}/${name})
  file(MAKE_DIRECTORY ${folder})
  configure_file(${CMAKE_SOURCE_DIR}/cmake/packages/copyright ${folder}/copyright COPYONLY)
  configure_file(${CMAKE_SOURCE_DIR}/cmake/packages/changelog.in ${folder}/changelog @ONLY)
  execute_process(COMMAND gzip -9nkf ${folder}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${folder}/copyright ${folder}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
          COMPONENT ${component})
endforeach()
foreach(page_of program:underbody studio:underbody-studio)
  string(REPLACE ":" ";" page_of ${page_of})
  list(GET page_of 0 component)
  list(GET page_of 1 name)
  add_custom_command(OUTPUT ${package_folder}/${name}.1.gz
    COMMAND gzip -9nc ${CMAKE_SOURCE_DIR}/docs/man/${name}.1 > ${package_folder}/${name}.1.gz
    DEPENDS ${CMAKE_SOURCE_DIR}/docs/man/${name}.1 VERBATIM)
  list(APPEND pages ${package_folder}/${name}.1.gz)
  install(FILES ${package_folder}/${name}.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
endforeach()
add_custom_target(manual_pages ALL DEPENDS ${pages})

# What Tab completes, written by the program itself.
set(completions ${package_folder}/completions)
add_custom_command(OUTPUT ${completions}/underbody ${completions}/_underbody ${completions}/underbody.fish
  COMMAND ${CMAKE_COMMAND} -E make_directory ${completions}
  COMMAND underbody completion bash > ${completions}/underbody
  COMMAND underbody completion zsh > ${completions}/_underbody
  COMMAND underbody completion fish > ${completions}/underbody.fish
  DEPENDS underbody VERBATIM)
add_custom_target(shell_completion ALL DEPENDS ${completions}/underbody)
install(FILES ${completions}/underbody DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${completions}/_underbody DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES ${completions}/underbody.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
        COMPONENT program)
# The shipped studies, to try the program with.
install(DIRECTORY ${CMAKE_SOURCE_DIR}/cases/evie ${CMAKE_SOURCE_DIR}/cases/evie-pitch
        DESTINATION ${CMAKE_INSTALL_DATADIR}/underbody/cases COMPONENT program
        PATTERN ".underbody" EXCLUDE PATTERN "runs" EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME underbody)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "Underbody")
set(CPACK_PACKAGE_CONTACT "Underbody developers <developers@underbody.org>")
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL ${package_components})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

set(about "This package is part of Underbody: from the fields that ANSYS or OpenFOAM
exported to loads, force tables, equilibria, stability maps and controller
tables of vehicles that glide close to a surface under water, and from
measured runs back to what the model lacks.")
foreach(component IN LISTS package_components)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_name_${component}})
endforeach()
# The first line is the short description.
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "ground-effect CFD studies, the command line
${about}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "fonts-dejavu-core, libqt5gui5")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "xvfb, libgl1-mesa-dri")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "openfoam, slurm-client, underbody-studio, gcc")

set(CPACK_COMPONENT_STUDIO_DESCRIPTION "ground-effect CFD studies, the desktop
${about}")
set(CPACK_DEBIAN_STUDIO_PACKAGE_DEPENDS "underbody (= ${PROJECT_VERSION}), fonts-dejavu-core")

set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "ground-effect CFD studies, the libraries
${about}

Static libraries, headers and a CMake package: find_package(Underbody).")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
# What UnderbodyDependencies.cmake looks for: the libraries that the project itself is built with.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/debian-packages.txt)
file(STRINGS ${CMAKE_SOURCE_DIR}/cmake/debian-packages.txt libraries REGEX "^(pkg-config|[a-z0-9.+-]+-dev)$")
list(FILTER libraries EXCLUDE REGEX "gtest|gmock|benchmark|pybind|python|cli11|dpkg")
list(JOIN libraries ", " libraries)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${libraries}")

set(CPACK_COMPONENT_PYTHON_DESCRIPTION "ground-effect CFD studies, the Python module
${about}

Every command as a function; fields as NumPy arrays and VTK objects.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11~), python3 (<< 3.12), python3-numpy, libqt5gui5")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "fonts-dejavu-core, xvfb")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-vtk9, python3-meshio, underbody")

# The date of everything in the packages.
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/cmake/packages/config.cmake)
set(CPACK_UNDERBODY_SOURCE ${CMAKE_SOURCE_DIR})
include(CPack)
