# The installed package: find_package(Underbody) gives underbody::core ... underbody::cases.
include(CMakePackageConfigHelpers)
configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/UnderbodyConfig.cmake.in
  ${CMAKE_BINARY_DIR}/UnderbodyConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Underbody)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/UnderbodyConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(EXPORT UnderbodyTargets NAMESPACE underbody:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Underbody
        COMPONENT development)
install(FILES ${CMAKE_BINARY_DIR}/UnderbodyConfig.cmake ${CMAKE_BINARY_DIR}/UnderbodyConfigVersion.cmake
              ${CMAKE_SOURCE_DIR}/cmake/UnderbodyDependencies.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Underbody COMPONENT development)
